// Target image: pictures as the program decodes them. The first byte picks the reader: a texture, or surroundings.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/scene/load_image.h"
#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers {

namespace {

constexpr size_t kMostTexelsPerByte = 8192;
constexpr size_t kMostBytes = 500;  // bytes: larger files may claim so many texels that one takes seconds
constexpr const char* kPng =
    "89504e470d0a1a0a0000000d49484452000000060000000408020000002266d91400000009704859730000000100000001004f25c4d600"
    "00002349444154789c63606060f80fc6ffc1d47f300f448059ffc1025885c04c0638051400004d371fe108b12d440000000049454e44ae"
    "426082";
constexpr const char* kJpeg =
    "ffd8ffe000104a46494600010200000100010000fffe00104c61766335392e33372e31303000ffdb0043000828282f282f373737373737"
    "413c414343434141414143434348484855555548484843434848505055555c5f5c575755575f5f646464787873738c8c91acaccfffc400"
    "68000100000000000000000000000000000005010101000000000000000000000000000001031000020104030101000000000000000000"
    "01110300412112b182710233110001020404070100000000000000000011120100410302312122134351810491343233ffc00011080008"
    "000803011200021200031200ffda000c03010002110311003f00346d144c60eb1e975f48b5ee1d8d252fe71f4e0d1fa236a4add191c012"
    "15318887b1e3758a339a96d3bbef5160d25b5a464e34786e5137f7e3ffd9";

std::string fromHex(std::string_view digits) {
    const auto value = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
    std::string bytes;
    for (size_t k = 0; k + 1 < digits.size(); k += 2) bytes += static_cast<char>(16 * value(digits[k]) + value(digits[k + 1]));
    return bytes;
}

}  // namespace

void runImage(Bytes bytes) {
    if (bytes.empty()) return;
    bytes = bytes.first(std::min(bytes.size(), kMostBytes));
    if (static_cast<int>(bytes[0]) % 2 == 0) {
        const Result<Image> image = decodeImage(bytes.subspan(1), "image");
        if (!image) return requireSentence(image.error().message);
        require(image->width >= 1 && image->height >= 1, "an image has texels");
        require(image->rgba.size() <= 4 * kMostTexelsPerByte * bytes.size(), "memory is in proportion to the file");
        require(image->rgba.size() == 4 * static_cast<size_t>(image->width) * static_cast<size_t>(image->height), "four bytes a texel");
        return;
    }
    const Result<HdrImage> image = loadHdr(fileOf(bytes.subspan(1), ".hdr"));
    if (!image) return requireSentence(image.error().message);
    require(image->texels.size() <= kMostTexelsPerByte * bytes.size(), "memory is in proportion to the file");
    require(image->texels.size() == static_cast<size_t>(image->width) * static_cast<size_t>(image->height), "one colour a texel");
    for (const vec3& t : image->texels)
        for (int k = 0; k < 3; ++k) require(t[k] >= 0 && t[k] <= 1000, "radiance is from 0 to 1000");
}

std::vector<std::string> imageSeeds() {
    const std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\2\0\40\0", 18), packedTga("\0\0\12\0\0\0\0\0\0\0\0\0\4\0\1\0\30\0", 18);
    const std::string bmp = std::string("BM\106\0\0\0\0\0\0\0\66\0\0\0\50\0\0\0\2\0\0\0\2\0\0\0\1\0\30\0", 30) + std::string(24 + 16, '\0');
    const std::string flatHdr =
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\nabc\x81"
        "defgabc\x80"
        "hij\x7f";
    const std::string packedHdr =
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\2\2\0\10", 49) + "\x88z\x88y\10abcdefgh\x84\x81\x84\x80";
    std::vector<std::string> all;
    for (const std::string& picture : {fromHex(kPng), fromHex(kJpeg), tga + std::string(16, 'x'),
                                       packedTga + "\x83"
                                                   "abc",
                                       bmp, flatHdr, packedHdr})
        for (const char reader : {'\0', '\1'}) all.push_back(reader + picture);
    return all;
}

}  // namespace rivulet::fuzzers
