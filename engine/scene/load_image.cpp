#include "engine/scene/load_image.h"

#include <fmt/format.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/file.h"

namespace rivulet {
namespace {

constexpr int kWidest = 16384;                                // texels
constexpr size_t kLargest = std::numeric_limits<int>::max();  // bytes: what stb_image takes

Error about(const std::string& name, std::string_view what) { return badInput(fmt::format("the image '{}' {}", name, what)); }

}  // namespace

Result<Image> decodeImage(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.empty()) return about(name, "is empty");
    if (bytes.size() > kLargest) return about(name, "is larger than 2 GiB");
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    Image image;
    image.name = name;
    int channels = 0;
    if (stbi_info_from_memory(data, size, &image.width, &image.height, &channels) == 0)
        return about(name, "cannot be read: it is damaged, or not a PNG, JPEG, TGA or BMP");
    if (std::max(image.width, image.height) > kWidest)
        return about(name, fmt::format("is {} x {} texels; make it no wider than {}", image.width, image.height, kWidest));
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
    if (std::max(image.width, image.height) > kWidest)
        return about(path, fmt::format("is {} x {} texels; make it no wider than {}", image.width, image.height, kWidest));
    float* texels = stbi_loadf_from_memory(data, size, &image.width, &image.height, &channels, 3);
    if (texels == nullptr) return about(path, fmt::format("cannot be read: {}", stbi_failure_reason()));
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
