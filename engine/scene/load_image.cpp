#include "engine/scene/load_image.h"

#include <fmt/format.h>
#include <malloc.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "engine/core/file.h"

namespace rivulet {
namespace {

constexpr int kWidest = 16384;                                // texels
constexpr size_t kLargest = std::numeric_limits<int>::max();  // bytes: what stb_image takes
constexpr size_t kMostTexelsPerByte = 8192;                   // a PNG of one colour with one bit a texel; what claims more takes seconds

// The JPEG decoder of stb_image 2.27 reads tables that a file lacks without having set them, which may crash: while this lives, memory that
// malloc gives is zero, as later versions make it.
class ZeroedMemory {
  public:
    ZeroedMemory() { (void)::mallopt(M_PERTURB, 0xFF); }
    ~ZeroedMemory() { (void)::mallopt(M_PERTURB, 0); }
    ZeroedMemory(const ZeroedMemory&) = delete;
    ZeroedMemory& operator=(const ZeroedMemory&) = delete;
};

// Whether a PNG has a part that claims more bytes than follow: stb_image takes memory for what is claimed, up to 2 GiB.
bool claimsTooMuch(std::span<const std::byte> file) {
    constexpr std::string_view kPng = "\x89PNG\r\n\x1A\n";
    const auto word = [&file](size_t at) {
        size_t value = 0;
        for (size_t k = 0; k < 4; ++k) value = value << 8U | static_cast<size_t>(file[at + k]);
        return value;
    };
    if (file.size() < kPng.size() || std::memcmp(file.data(), kPng.data(), kPng.size()) != 0) return false;
    constexpr size_t kFrame = 12, kEnd = 0x49454E44;  // bytes of length, name and checksum; "IEND"
    for (size_t at = kPng.size(); at + kFrame <= file.size();) {
        if (word(at) > file.size() - at - kFrame) return true;
        if (word(at + 4) == kEnd) break;
        at += kFrame + word(at);
    }
    return false;
}

Error about(const std::string& name, std::string_view what) { return badInput(fmt::format("the image '{}' {}", name, what)); }

Status checkSize(const std::string& name, int width, int height, size_t bytes) {
    if (std::min(width, height) < 1) return about(name, "has no texels; save it again");
    if (std::max(width, height) > kWidest)
        return about(name, fmt::format("is {} x {} texels; make it no wider than {}", width, height, kWidest));
    if (static_cast<size_t>(width) * static_cast<size_t>(height) > kMostTexelsPerByte * bytes)
        return about(name, fmt::format("is damaged: {} bytes cannot hold {} x {} texels; save it again", bytes, width, height));
    return ok();
}

// The bytes of an .hdr file. Where a file ends within a run, stb_image 2.27 waits for the rest for ever: reads past the end return 0xFF,
// which the decoder takes as a complete run, and stops.
struct HdrBytes {
    std::string_view bytes;
    size_t at = 0;
    bool ended = false;  // more was read than there is

    static int read(void* user, char* data, int size) {
        auto& file = *static_cast<HdrBytes*>(user);
        const size_t count = std::min(static_cast<size_t>(size), file.bytes.size() - file.at);
        std::copy_n(file.bytes.data() + file.at, count, data);
        file.at += count;
        if (count > 0 || size == 0) return static_cast<int>(count);
        file.ended = true;
        std::fill_n(data, size, static_cast<char>(0xFF));
        return size;
    }
    static void skip(void* user, int count) {
        auto& file = *static_cast<HdrBytes*>(user);
        file.at = std::min(file.at + static_cast<size_t>(std::max(count, 0)), file.bytes.size());
    }
    static int hasEnded(void* user) {
        const auto& file = *static_cast<const HdrBytes*>(user);
        return file.at == file.bytes.size() ? 1 : 0;
    }
};

}  // namespace

Result<Image> decodeImage(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.empty()) return about(name, "is empty");
    if (bytes.size() > kLargest) return about(name, "is larger than 2 GiB");
    if (claimsTooMuch(bytes)) return about(name, "cannot be read: it is cut off or damaged; save it again");
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    Image image;
    image.name = name;
    int channels = 0;
    if (stbi_info_from_memory(data, size, &image.width, &image.height, &channels) == 0)
        return about(name, "cannot be read: it is damaged, or not a PNG, JPEG, TGA or BMP");
    if (stbi_is_hdr_from_memory(data, size) != 0) return about(name, "is an HDR picture, which no material has; save it as PNG");
    if (Status fits = checkSize(name, image.width, image.height, bytes.size()); !fits) return fits.error();
    const ZeroedMemory zeroed;
    stbi_uc* texels = stbi_load_from_memory(data, size, &image.width, &image.height, &channels, 4);
    if (texels == nullptr) return about(name, fmt::format("cannot be read: {}", stbi_failure_reason()));
    const size_t row = static_cast<size_t>(image.width) * 4, rows = static_cast<size_t>(image.height);
    image.rgba.resize(row * rows);
    for (size_t y = 0; y < rows; ++y)
        std::copy_n(texels + y * row, row, image.rgba.begin() + static_cast<std::ptrdiff_t>((rows - 1 - y) * row));
    stbi_image_free(texels);
    return image;
}

Result<Image> loadImage(const std::string& path) {
    const Result<std::string> bytes = readFile(path, kLargest);
    if (!bytes) return bytes.error();
    return decodeImage(std::as_bytes(std::span(*bytes)), path);
}

Result<HdrImage> loadHdr(const std::string& path) {
    const Result<std::string> bytes = readFile(path, kLargest);
    if (!bytes) return bytes.error();
    if (bytes->empty()) return about(path, "is empty");
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes->data());
    const int size = static_cast<int>(bytes->size());
    HdrImage image;
    image.name = path;
    int channels = 0;
    if (stbi_info_from_memory(data, size, &image.width, &image.height, &channels) == 0)
        return about(path, "cannot be read: it is damaged, or no HDR");
    if (stbi_is_hdr_from_memory(data, size) == 0) return about(path, "is no HDR picture; save it as .hdr");
    if (Status fits = checkSize(path, image.width, image.height, bytes->size()); !fits) return fits.error();
    HdrBytes file;
    file.bytes = *bytes;
    const stbi_io_callbacks reader{HdrBytes::read, HdrBytes::skip, HdrBytes::hasEnded};
    float* texels = stbi_loadf_from_callbacks(&reader, &file, &image.width, &image.height, &channels, 3);
    if (texels == nullptr) return about(path, fmt::format("cannot be read: {}", stbi_failure_reason()));
    if (file.ended) {
        stbi_image_free(texels);
        return about(path, "is cut off; save it again");
    }
    const size_t row = static_cast<size_t>(image.width), rows = static_cast<size_t>(image.height);
    image.texels.resize(row * rows);
    auto sane = [](float x) { return std::isfinite(x) ? std::clamp(x, 0.0F, 1000.0F) : 0.0F; };
    for (size_t y = 0; y < rows; ++y)
        for (size_t x = 0; x < row; ++x) {
            const float* t = texels + 3 * (y * row + x);
            image.texels[(rows - 1 - y) * row + x] = vec3(sane(t[0]), sane(t[1]), sane(t[2]));
        }
    stbi_image_free(texels);
    return image;
}

}  // namespace rivulet
