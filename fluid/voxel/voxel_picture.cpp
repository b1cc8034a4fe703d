// Slices: a plane of labels or distances, with several samples per pixel.
#include "fluid/voxel/voxel_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/assert.h"
#include "engine/core/parallel.h"

namespace rivulet {
namespace {

constexpr vec3 kOutsideColour{0.84F, 0.87F, 0.90F}, kSurfaceColour{0.030F, 0.042F, 0.060F};
constexpr vec3 kPaper{0.93F, 0.925F, 0.91F}, kTrack{0.80F, 0.80F, 0.79F}, kMark{0.22F, 0.26F, 0.31F};
constexpr int kLinesInBand = 5;

vec3 mix(const vec3& a, const vec3& b, float t) { return a + (b - a) * t; }

float srgb(float v) {
    v = std::clamp(v, 0.0F, 1.0F);
    return v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1.0F / 2.4F) - 0.055F;
}

void put(VoxelPicture& picture, int x, int y, const vec3& linear) {
    const uint32_t bytes = srgbBytes(linear);
    const size_t at = 4 * (static_cast<size_t>(y) * static_cast<size_t>(picture.width) + static_cast<size_t>(x));
    for (size_t k = 0; k < 4; ++k) picture.rgba[at + k] = static_cast<uint8_t>(bytes >> (8 * k));
}

VoxelPicture blank(int width, int height) {
    VoxelPicture picture{width, height, {}};
    picture.rgba.resize(4 * static_cast<size_t>(width) * static_cast<size_t>(height));
    return picture;
}

// A plane of voxels' labels.
struct LabelPlane {
    int width, height;
    std::vector<uint32_t> labels;  // rows from the bottom up

    LabelPlane(const VoxelLabels& from, int axis, int at) {
        const ivec2 axes = sliceAxes(axis);
        width = from.size[axes.x];
        height = from.size[axes.y];
        labels.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < (axis == 0 ? width : 1); ++u) {
                ivec3 c(0);
                c[axis] = at;
                c[axes.x] = u;
                c[axes.y] = v;
                uint32_t* row = &labels[static_cast<size_t>(v) * static_cast<size_t>(width)];
                if (axis == 0) {
                    row[u] = from.at(c);
                    continue;
                }
                const std::span<const LabelRun> runs = from.row(c.y, c.z);
                for (size_t k = 0; k < runs.size(); ++k)
                    std::fill(row + runs[k].x, row + (k + 1 < runs.size() ? runs[k + 1].x : static_cast<uint32_t>(width)), runs[k].label);
            }
        }
    }
    uint32_t at(int u, int v) const { return labels[static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)]; }
};

// A plane through a field of distances, between its grid points.
class DistancePlane {
  public:
    DistancePlane(std::span<const float> distance, const ivec3& size, int axis, float at)
        : distance_(distance), size_(size), axis_(axis), at_(at), axes_(sliceAxes(axis)) {}
    // At (u, v) in voxels along the slice's axes.
    float operator()(float u, float v) const {
        vec3 p;
        p[axis_] = at_;
        p[axes_.x] = u;
        p[axes_.y] = v;
        p = glm::clamp(p, vec3(0.0F), vec3(size_));
        const ivec3 cell = glm::min(ivec3(p), size_ - ivec3(1));
        const vec3 f = p - vec3(cell);
        float sum = 0;
        for (int k = 0; k < 8; ++k) {
            const ivec3 o(k & 1, (k >> 1) & 1, k >> 2);
            const ivec3 c = cell + o;
            const float weight = (o.x != 0 ? f.x : 1 - f.x) * (o.y != 0 ? f.y : 1 - f.y) * (o.z != 0 ? f.z : 1 - f.z);
            const auto row = static_cast<size_t>(c.z) * static_cast<size_t>(size_.y + 1) + static_cast<size_t>(c.y);
            sum += weight * distance_[row * static_cast<size_t>(size_.x + 1) + static_cast<size_t>(c.x)];
        }
        return sum;
    }

  private:
    std::span<const float> distance_;
    ivec3 size_;
    int axis_;
    float at_;
    ivec2 axes_;
};

// Share of a pixel, `pixel` voxels wide, that the nearest iso-line covers, 0..1. The surface and the end of the band have no line.
float lineAt(const DistancePlane& plane, float u, float v, float band, float pixel) {
    const float distance = plane(u, v), step = band / kLinesInBand;
    const float nearest = std::round(distance / step) * step;
    if (std::abs(nearest) < 0.5F * step || std::abs(nearest) > band - 0.5F * step) return 0;
    const float slope = 0.5F * glm::length(vec2(plane(u + 1, v) - plane(u - 1, v), plane(u, v + 1) - plane(u, v - 1)));
    if (!(slope > 0)) return 0;
    return std::clamp(1.15F - std::abs(distance - nearest) / (slope * pixel), 0.0F, 1.0F);
}

// The layers that are not all outside.
ivec2 layersOf(const VoxelLabels& labels) {
    ivec2 range(labels.size.z, -1);
    for (int z = 0; z < labels.size.z; ++z) {
        for (int y = 0; y < labels.size.y; ++y) {
            const std::span<const LabelRun> runs = labels.row(y, z);
            if (runs.size() == 1 && runs[0].label == kOutside) continue;
            range = {std::min(range.x, z), z};
            break;
        }
    }
    return range.y < 0 ? ivec2(0, labels.size.z - 1) : range;
}

std::vector<vec3> coloursOf(const VoxelLabels& labels) {
    std::vector<vec3> colours;
    for (size_t k = 0; k < kFirstMaterial + labels.materials.size(); ++k) colours.push_back(labelColour(labels, static_cast<uint32_t>(k)));
    return colours;
}

// Places of the tiles of a sheet, in pixels.
struct SheetLayout {
    static constexpr int kMargin = 36, kGap = 20, kTrackBelow = 9, kTrackHeight = 3, kLongest = 340;
    int columns, rows, tileWidth, tileHeight;
    SheetLayout(int count, int width, int height) {
        columns = std::min(count, 4);
        rows = (count + columns - 1) / columns;
        const float scale = static_cast<float>(kLongest) / static_cast<float>(std::max(width, height));
        tileWidth = std::max(8, static_cast<int>(std::lround(scale * static_cast<float>(width))));
        tileHeight = std::max(8, static_cast<int>(std::lround(scale * static_cast<float>(height))));
    }
    int cellHeight() const { return tileHeight + kTrackBelow + kTrackHeight; }
    int width() const { return 2 * kMargin + columns * tileWidth + (columns - 1) * kGap; }
    int height() const { return 2 * kMargin + rows * cellHeight() + (rows - 1) * kGap; }
    ivec2 corner(int k) const { return {kMargin + (k % columns) * (tileWidth + kGap), kMargin + (k / columns) * (cellHeight() + kGap)}; }
};

}  // namespace

uint32_t srgbBytes(const vec3& linear) {
    uint32_t bytes = 0xFF000000U;
    for (int k = 0; k < 3; ++k) bytes |= static_cast<uint32_t>(std::lround(255 * srgb(linear[k]))) << (8U * static_cast<unsigned>(k));
    return bytes;
}

vec3 labelColour(const VoxelLabels& labels, uint32_t label) {
    if (label == kOutside) return kOutsideColour;
    if (label == kInsideSurface) return kSurfaceColour;
    const vec3 colour = materialColour(label - kFirstMaterial);
    return labels.materials[label - kFirstMaterial].solid ? colour : mix(colour, kOutsideColour, 0.65F);
}

ivec2 sliceAxes(int axis) { return axis == 0 ? ivec2(2, 1) : axis == 1 ? ivec2(0, 2) : ivec2(0, 1); }

VoxelPicture drawSlice(const VoxelLabels& labels, int axis, int at) {
    ASSERT(axis >= 0 && axis < 3 && at >= 0 && at < labels.size[axis], "a slice lies inside the grid");
    const LabelPlane plane(labels, axis, at);
    const std::vector<vec3> colours = coloursOf(labels);
    VoxelPicture picture = blank(plane.width, plane.height);
    for (int v = 0; v < plane.height; ++v) {
        for (int u = 0; u < plane.width; ++u) put(picture, u, plane.height - 1 - v, colours[plane.at(u, v)]);
    }
    return picture;
}

VoxelPicture drawBandSlice(std::span<const float> distance, float band, const ivec3& size, int axis, int at) {
    ASSERT(axis >= 0 && axis < 3 && at >= 0 && at < size[axis], "a slice lies inside the grid");
    constexpr vec3 kFar{0.86F, 0.88F, 0.90F}, kNear{0.02F, 0.12F, 0.24F}, kWithin{0.42F, 0.10F, 0.03F};
    const DistancePlane plane(distance, size, axis, static_cast<float>(at) + 0.5F);
    const ivec2 axes = sliceAxes(axis);
    constexpr int kPerVoxel = 3;  // pixels
    VoxelPicture picture = blank(kPerVoxel * size[axes.x], kPerVoxel * size[axes.y]);
    parallelFor(0, picture.height, [&](int y) {
        for (int x = 0; x < picture.width; ++x) {
            const float u = (static_cast<float>(x) + 0.5F) / kPerVoxel, v = (static_cast<float>(picture.height - 1 - y) + 0.5F) / kPerVoxel;
            const float d = plane(u, v), away = std::min(std::abs(d) / band, 1.0F);
            vec3 colour = mix(d < 0 ? kWithin : kNear, kFar, std::pow(away, 0.6F));
            colour = mix(colour, vec3(1.0F), 0.45F * lineAt(plane, u, v, band, 1.0F / kPerVoxel));
            put(picture, x, y, colour);
        }
    });
    return picture;
}

VoxelPicture drawSlices(const VoxelLabels& labels, std::span<const float> distance, float band) {
    const ivec2 layers = layersOf(labels);
    const int count = std::min(16, layers.y - layers.x + 1);
    const std::vector<vec3> colours = coloursOf(labels);
    const SheetLayout layout(count, labels.size.x, labels.size.y);
    VoxelPicture sheet = blank(layout.width(), layout.height());
    const uint32_t paper = srgbBytes(kPaper);
    for (size_t k = 0; k < sheet.rgba.size(); ++k) sheet.rgba[k] = static_cast<uint8_t>(paper >> (8 * (k % 4)));

    parallelFor(0, count, [&](int k) {
        const int z = count == 1 ? layers.x : layers.x + (layers.y - layers.x) * k / (count - 1);
        const LabelPlane plane(labels, 2, z);
        const DistancePlane away(distance, labels.size, 2, static_cast<float>(z) + 0.5F);
        const ivec2 corner = layout.corner(k);
        const float perPixel = static_cast<float>(plane.width) / static_cast<float>(layout.tileWidth);  // voxels
        const float upPerPixel = static_cast<float>(plane.height) / static_cast<float>(layout.tileHeight);
        const int samples = std::clamp(static_cast<int>(std::ceil(2 * perPixel)), 3, 16);
        const auto toU = [&](float x) { return x * perPixel; };
        const auto toV = [&](float y) { return (static_cast<float>(layout.tileHeight) - y) * upPerPixel; };
        for (int y = 0; y < layout.tileHeight; ++y) {
            for (int x = 0; x < layout.tileWidth; ++x) {
                const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
                const float line = distance.empty() ? 0.0F : 0.4F * lineAt(away, toU(fx + 0.5F), toV(fy + 0.5F), band, perPixel);
                vec3 sum(0.0F);
                for (int s = 0; s < samples * samples; ++s) {
                    const ivec2 cell(s % samples, s / samples);
                    const vec2 within = (vec2(cell) + 0.5F) / static_cast<float>(samples);
                    const int u = std::min(static_cast<int>(toU(fx + within.x)), plane.width - 1);
                    const int v = std::clamp(static_cast<int>(toV(fy + within.y)), 0, plane.height - 1);
                    const uint32_t label = plane.at(u, v);
                    const vec3& colour = colours[label];
                    sum += label == kInsideSurface ? colour : mix(colour, 0.35F * colour, line);
                }
                put(sheet, corner.x + x, corner.y + y, sum / static_cast<float>(samples * samples));
            }
        }
        const int markWidth = std::max(6, layout.tileWidth / 12);
        const float along = labels.size.z == 1 ? 0.0F : static_cast<float>(z) / static_cast<float>(labels.size.z - 1);
        const int mark = static_cast<int>(std::lround(along * static_cast<float>(layout.tileWidth - markWidth)));
        for (int y = 0; y < SheetLayout::kTrackHeight; ++y) {
            for (int x = 0; x < layout.tileWidth; ++x)
                put(sheet, corner.x + x, corner.y + layout.tileHeight + SheetLayout::kTrackBelow + y,
                    x >= mark && x < mark + markWidth ? kMark : kTrack);
        }
    });
    return sheet;
}

}  // namespace rivulet
