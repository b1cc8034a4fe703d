// Draws work boxes on a device, and fills lines on the host, in the thesis's order within a box [4.1].
#include "fluid/voxel/voxelize_depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "engine/core/assert.h"
#include "engine/core/parallel.h"
#include "fluid/voxel/depth_jobs.h"

namespace rivulet {
namespace {

constexpr size_t kGroupPixels = size_t{1} << 22U;  // of boxes drawn at once, unless one box has more; 32 MiB of images
constexpr size_t kJobsBytes = size_t{1} << 26U;    // of a buffer on a GPU

// State of a voxel: lines along x, y, z have passed it; a line hits in it; it has a label.
constexpr uint8_t kPassed = 7, kHit = 8, kLabelled = 16;

// Draws boxes on any device.
class BoxPainter {
  public:
    BoxPainter(Device& device, std::vector<DepthJob> jobs) : device_(device), jobs_(std::move(jobs)) {}

    Status prepare() {
        if (device_.backend() == Backend::cpu) return ok();
        Result<Kernel> kernel = device_.kernel("voxel/voxelize_depth");
        if (!kernel)
            return failed(fmt::format("Mode depth cannot run on this device, possibly because it has no 64-bit floats ({}); use the cpu.",
                                      kernel.error().message));
        kernel_ = *kernel;
        const size_t most = kJobsBytes / sizeof(DepthJob);
        for (size_t first = 0; first < jobs_.size(); first += most) {
            const std::span<const DepthJob> part = std::span(jobs_).subspan(first, std::min(most, jobs_.size() - first));
            Result<Buffer> buffer = device_.allocate(part.size_bytes());
            if (!buffer) return buffer.error();
            device_.writeAll(*buffer, part);
            parts_.push_back({std::move(*buffer), static_cast<uint32_t>(part.size())});
        }
        return ok();
    }

    // `pixels`: of all boxes. Two words a pixel, until the next call.
    Result<std::span<const uint32_t>> draw(DepthParams params, std::span<const DepthBox> boxes, size_t pixels) {
        images_.resize(2 * pixels);
        if (device_.backend() == Backend::cpu) {
            std::fill(images_.begin(), images_.end(), 0xFFFFFFFFU);
            drawDepthJobs(jobs_, params, boxes, images_);
            return std::span<const uint32_t>(images_);
        }
        Result<Buffer> boxBuffer = device_.allocate(boxes.size_bytes());
        if (!boxBuffer) return boxBuffer.error();
        device_.writeAll(*boxBuffer, boxes);
        const size_t bytes = images_.size() * sizeof(uint32_t);
        if (imageBuffer_.bytes() < bytes) {
            imageBuffer_ = Buffer();
            Result<Buffer> buffer = device_.allocate(bytes);
            if (!buffer) return buffer.error();
            imageBuffer_ = std::move(*buffer);
        }
        device_.fill(imageBuffer_, 0xFFFFFFFFU);
        for (const Part& part : parts_) {
            params.jobs = part.count;
            device_.run(kernel_, params, {&part.jobs, &*boxBuffer, &imageBuffer_}, part.count);
        }
        device_.read(imageBuffer_, std::as_writable_bytes(std::span(images_)));
        return std::span<const uint32_t>(images_);
    }

  private:
    struct Part {
        Buffer jobs;
        uint32_t count;
    };
    Device& device_;
    std::vector<DepthJob> jobs_;
    std::vector<Part> parts_;
    std::vector<uint32_t> images_;
    Buffer imageBuffer_;
    Kernel kernel_;
};

size_t pixelsOf(const DepthBox& box) {
    if (box.highX < box.lowX) return 0;
    const auto x = static_cast<size_t>(box.highX - box.lowX + 1), y = static_cast<size_t>(box.highY - box.lowY + 1),
               z = static_cast<size_t>(box.highZ - box.lowZ + 1);
    return x * y + y * z + x * z;
}

class Filler {
  public:
    explicit Filler(const ivec3& size) : size_(size) {
        stride_ = {1, static_cast<size_t>(size.x), static_cast<size_t>(size.x) * static_cast<size_t>(size.y)};
        const size_t count = stride_[2] * static_cast<size_t>(size.z);
        state_.assign(count, 0);
        label_.assign(count, kNone);
    }

    // Bounds of the unknown voxels in each slab.
    std::vector<DepthBox> unknownBoxes(int axis, int thickness) const {
        std::vector<DepthBox> boxes(static_cast<size_t>((size_[axis] + thickness - 1) / thickness),
                                    {size_.x, size_.y, size_.z, -1, -1, -1, 0, 0});
        const auto add = [&](int x, int y, int z) {
            DepthBox& box = boxes[static_cast<size_t>(pick(axis, x, y, z) / thickness)];
            box = {std::min(box.lowX, x),
                   std::min(box.lowY, y),
                   std::min(box.lowZ, z),
                   std::max(box.highX, x),
                   std::max(box.highY, y),
                   std::max(box.highZ, z),
                   0,
                   0};
        };
        for (int z = 0; z < size_.z; ++z) {
            for (int y = 0; y < size_.y; ++y) {
                const uint8_t* row = &state_[at({0, y, z})];
                const auto unknown = [](uint8_t state) { return (state & (kHit | kLabelled)) == 0; };
                const uint8_t* end = row + size_.x;
                const uint8_t* first = std::find_if(row, end, unknown);
                if (first == end) continue;
                const uint8_t* last = end - 1;
                while (!unknown(*last)) --last;
                if (axis == 0) {
                    for (const uint8_t* voxel = first; voxel <= last; ++voxel)
                        if (unknown(*voxel)) add(static_cast<int>(voxel - row), y, z);
                } else {
                    add(static_cast<int>(first - row), y, z);
                    add(static_cast<int>(last - row), y, z);
                }
            }
        }
        return boxes;
    }

    // Updates the voxels of a box from its images.
    void see(const DepthBox& box, std::span<const uint32_t> images) {
        const auto width = static_cast<uint32_t>(box.highX - box.lowX + 1), height = static_cast<uint32_t>(box.highY - box.lowY + 1),
                   depth = static_cast<uint32_t>(box.highZ - box.lowZ + 1);
        parallelFor(uint32_t{0}, depth, [&](uint32_t k) {
            for (uint32_t j = 0; j < height; ++j) {
                const int y = box.lowY + static_cast<int>(j), z = box.lowZ + static_cast<int>(k);
                uint8_t* state = &state_[at({box.lowX, y, z})];
                const uint32_t* alongX = &images[pixelOf(box, 0, box.lowX, y, z)];
                const uint32_t* alongY = &images[pixelOf(box, 1, box.lowX, y, z)];
                const uint32_t* alongZ = &images[pixelOf(box, 2, box.lowX, y, z)];
                for (uint32_t i = 0; i < width; ++i, alongY += 2, alongZ += 2) {
                    const uint32_t behindX = width - 1 - i, behindY = height - 1 - j, behindZ = depth - 1 - k;
                    const bool x = i < alongX[0] || behindX < alongX[1];
                    const bool y1 = j < alongY[0] || behindY < alongY[1];
                    const bool z1 = k < alongZ[0] || behindZ < alongZ[1];
                    const bool hit = i == alongX[0] || behindX == alongX[1] || j == alongY[0] || behindY == alongY[1] || k == alongZ[0] ||
                                     behindZ == alongZ[1];
                    state[i] = static_cast<uint8_t>(state[i] | (x ? 1 : 0) | (y1 ? 2 : 0) | (z1 ? 4 : 0) | (hit ? kHit : 0));
                }
            }
        });
    }

    // Labels the free voxels of a box: its six faces, then its inside, plane by plane. `thin`: the axis that comes last, of a slab.
    void fill(const DepthBox& box, std::optional<int> thin) {
        const ivec3 low(box.lowX, box.lowY, box.lowZ), high(box.highX, box.highY, box.highZ);
        for (int axis = 0; axis < 3; ++axis) {
            fillPlane(axis, low[axis], low, high);
            if (high[axis] > low[axis]) fillPlane(axis, high[axis], low, high);
        }
        const int across = thin.value_or(2);
        for (int k = low[across] + 1; k < high[across]; ++k) fillPlane(across, k, low, high);
        if (thin) {
            const int u = axisU(*thin), v = axisV(*thin);
            ivec3 c = low;
            for (c[v] = low[v]; c[v] <= high[v]; ++c[v])
                for (c[u] = low[u]; c[u] <= high[u]; ++c[u])
                    joinLine(*thin, at(c) - stride_[idx(*thin)] * idx(low[*thin]), low[*thin], high[*thin]);
        }
    }

    // Every line of layer z, along x, y and z: joins labels of neighbours, and joins voxels at the grid's border with the outside.
    void joinLayer(int z) {
        for (int y = 0; y < size_.y; ++y) {
            const size_t row = at({0, y, z});
            const bool border = y == 0 || z == 0 || y == size_.y - 1 || z == size_.z - 1;
            for (size_t i = row; i < row + stride_[1]; ++i) {
                const uint32_t label = label_[i];
                if (label == kNone) continue;
                if (border || i == row || i + 1 == row + stride_[1]) unite(label, kOut);
                if (i > row) unite(label, label_[i - 1]);
                if (y > 0) unite(label, label_[i - stride_[1]]);
                if (z > 0) unite(label, label_[i - stride_[2]]);
            }
        }
    }

    // Each voxel's region: 0 outside, else any number below regions().
    std::vector<uint32_t> takeRegions() {
        for (uint32_t k = 1; k < parent_.size(); ++k) parent_[k] = parent_[parent_[k]];  // parents come first
        for (size_t k = 0; k < label_.size(); ++k) {
            ASSERT((state_[k] & (kHit | kLabelled)) != 0, "divide the box until every voxel is known");
            label_[k] = label_[k] == kNone ? 0 : parent_[label_[k]] - kOut;
        }
        return std::move(label_);
    }
    uint32_t regions() const { return static_cast<uint32_t>(parent_.size()); }

    void takeSurface(VoxelGrid& grid) const {
        parallelFor(size_t{0}, (state_.size() + 7) / 8, [&](size_t byte) {
            unsigned bits = 0;
            for (size_t k = 8 * byte; k < std::min(state_.size(), 8 * byte + 8); ++k)
                bits |= ((state_[k] & kHit) != 0 ? 1U : 0U) << (k & 7U);
            grid.bits[byte] = static_cast<uint8_t>(bits);
        });
    }

  private:
    static constexpr uint32_t kNone = 0, kOut = 1;  // labels; a root is the smallest of its set

    static size_t idx(int k) { return static_cast<size_t>(k); }
    size_t at(const ivec3& c) const { return idx(c.x) + stride_[1] * idx(c.y) + stride_[2] * idx(c.z); }
    bool fillable(size_t i) const { return (state_[i] & (kPassed | kHit | kLabelled)) == kPassed; }

    uint32_t find(uint32_t label) {
        while (parent_[label] != label) label = parent_[label] = parent_[parent_[label]];
        return label;
    }

    // Without effect for kNone.
    uint32_t unite(uint32_t a, uint32_t b) {
        if (a == b || b == kNone) return a;
        if (a == kNone) return b;
        a = find(a);
        b = find(b);
        if (a > b) std::swap(a, b);
        return parent_[b] = a;
    }

    // The voxel at `k` of the line along an axis that starts at voxel `line`.
    uint32_t labelAt(int axis, size_t line, int k) const {
        return k < 0 || k >= size_[axis] ? kOut : label_[line + stride_[idx(axis)] * idx(k)];
    }

    // A segment takes the label of a voxel at one of its ends, or a new label.
    void fillSegment(int axis, size_t line, int first, int last) {
        uint32_t label = unite(labelAt(axis, line, first - 1), labelAt(axis, line, last + 1));
        if (label == kNone) {
            label = static_cast<uint32_t>(parent_.size());
            parent_.push_back(label);
        }
        for (int k = first; k <= last; ++k) {
            const size_t i = line + stride_[idx(axis)] * idx(k);
            label_[i] = label;
            state_[i] |= kLabelled;
        }
    }

    void fillLine(int axis, size_t line, int low, int high) {
        const size_t stride = stride_[idx(axis)];
        for (int k = low; k <= high; ++k) {
            if (!fillable(line + stride * idx(k))) continue;
            const int first = k;
            while (k < high && fillable(line + stride * idx(k + 1))) ++k;
            fillSegment(axis, line, first, k);
        }
    }

    void joinLine(int axis, size_t line, int low, int high) {
        uint32_t before = labelAt(axis, line, low - 1);
        for (int k = low; k <= high + 1; ++k) {
            const uint32_t label = labelAt(axis, line, k);
            if (before != kNone) unite(before, label);
            before = label;
        }
    }

    // Lines through an unknown point, lines along the border, then the rectangles between: of the four the two that were searched
    // before the point was found have nothing unknown, nor has that border.
    void fillPlane(int axis, int k, const ivec3& low, const ivec3& high) {
        const int u = axisU(axis), v = axisV(axis);
        const size_t plane = stride_[idx(axis)] * idx(k), su = stride_[idx(u)], sv = stride_[idx(v)];
        const auto lineU = [&](int row, int from, int to) { fillLine(u, plane + sv * idx(row), from, to); };
        const auto lineV = [&](int column, int from, int to) { fillLine(v, plane + su * idx(column), from, to); };
        rectangles_.assign(1, {low[u], low[v], high[u], high[v]});
        while (!rectangles_.empty()) {
            const auto [u0, v0, u1, v1] = rectangles_.back();
            rectangles_.pop_back();
            bool found = false;
            for (int row = v0; row <= v1 && !found; ++row) {
                for (int column = u0; column <= u1 && !found; ++column) {
                    if (!fillable(plane + su * idx(column) + sv * idx(row))) continue;
                    found = true;
                    lineU(row, u0, u1);
                    lineV(column, row, v1);
                    lineU(v1, u0, u1);
                    lineV(u0, row, v1);
                    lineV(u1, row, v1);
                    rectangles_.push_back({column + 1, row + 1, u1 - 1, v1 - 1});
                    rectangles_.push_back({u0 + 1, row + 1, column - 1, v1 - 1});
                }
            }
        }
    }

    ivec3 size_;
    std::array<size_t, 3> stride_{};
    std::vector<uint8_t> state_;
    std::vector<uint32_t> label_, parent_{kNone, kOut};
    std::vector<std::array<int, 4>> rectangles_;
};

class DepthVoxelizer {
  public:
    DepthVoxelizer(BoxPainter& painter, const VoxelGrid& grid, const DepthOptions& options, DepthVoxels& result)
        : painter_(painter), size_(grid.size), options_(options), result_(result), filler_(grid.size) {}

    Status run() {
        struct Division {
            int axis, thickness;
        };
        std::vector<Division> divisions;
        const int half = std::min(size_.x, std::min(size_.y, size_.z)) / 2;
        for (int thickness = options_.thesisOrder ? std::max(1, half) : 1; thickness > 0; --thickness)
            for (int axis = 0; axis < 3; ++axis) divisions.push_back({axis, thickness});
        if (Status status = divide(2, size_.z, true); !status) return status;
        for (size_t k = 0; k < divisions.size() && unknown_; ++k) {
            if (options_.progress && !options_.progress(static_cast<double>(k) / static_cast<double>(divisions.size())))
                return failed("Voxelising was cancelled.");
            if (Status status = divide(divisions[k].axis, divisions[k].thickness, false); !status) return status;
        }
        for (int z = 0; z < size_.z; ++z) filler_.joinLayer(z);
        filler_.takeSurface(result_.surface);
        const uint32_t regions = filler_.regions();
        result_.labels = labelsOf(result_.surface, filler_.takeRegions(), regions);
        return ok();
    }

  private:
    // Draws and fills the unknown voxels of each slab. Several slabs are drawn at once, as memory allows, because filling one makes no
    // voxel of another known.
    Status divide(int axis, int thickness, bool whole) {
        std::vector<DepthBox> boxes = filler_.unknownBoxes(axis, thickness);
        unknown_ = std::any_of(boxes.begin(), boxes.end(), [](const DepthBox& box) { return box.highX >= 0; });
        for (size_t first = 0; first < boxes.size();) {
            size_t end = first, pixels = 0;
            for (; end < boxes.size() && (pixels == 0 || pixels + pixelsOf(boxes[end]) <= kGroupPixels); ++end) {
                boxes[end].image = static_cast<uint32_t>(pixels);
                pixels += pixelsOf(boxes[end]);
                result_.boxes += boxes[end].highX >= 0 ? 1 : 0;
            }
            if (pixels > 0) {
                DepthParams params{};
                params.sizeX = size_.x;
                params.sizeY = size_.y;
                params.sizeZ = size_.z;
                params.slabAxis = axis;
                params.thickness = thickness;
                params.firstSlab = static_cast<int>(first);
                params.slabs = static_cast<int>(end - first);
                const Result<std::span<const uint32_t>> images =
                    painter_.draw(params, std::span(boxes).subspan(first, end - first), pixels);
                if (!images) return images.error();
                result_.pixels += pixels;
                for (size_t k = first; k < end; ++k) {
                    if (boxes[k].highX < 0) continue;
                    filler_.see(boxes[k], *images);
                    filler_.fill(boxes[k], whole ? std::nullopt : std::optional(axis));
                }
            }
            first = end;
        }
        return ok();
    }

    BoxPainter& painter_;
    ivec3 size_;
    const DepthOptions& options_;
    DepthVoxels& result_;
    Filler filler_;
    bool unknown_ = true;  // whether a voxel was unknown before the last division
};

}  // namespace

Result<DepthVoxels> voxelizeDepth(Device& device, std::span<const MeshView> meshes, const VoxelGrid& grid, const DepthOptions& options) {
    DepthVoxels result;
    result.surface = grid;
    BoxPainter painter(device, depthJobs(meshes, grid));
    if (Status status = painter.prepare(); !status) return status.error();
    if (Status status = DepthVoxelizer(painter, grid, options, result).run(); !status) return status.error();
    return result;
}

double depthBytes(const dvec3& size) {
    const double voxels = size.x * size.y * size.z;
    const double pixels = std::max(static_cast<double>(kGroupPixels), size.x * size.y + size.y * size.z + size.x * size.z);
    return voxels * (sizeof(uint8_t) + sizeof(uint32_t)) + pixels * 2 * sizeof(uint32_t);
}

}  // namespace rivulet
