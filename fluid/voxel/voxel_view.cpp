// The view from outside: rays through the grid, voxel by voxel where there is something near (Amanatides and Woo 1987), a brick of 16^3 at
// a time where there is nothing. Light from a whole sky and one soft sun, by rays too.
#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fluid/voxel/voxel_picture.h"

namespace rivulet {
namespace {

constexpr int kMostCells = 512;
constexpr int kBrick = 16;  // cells; of 4, 8 and 16 the fastest

constexpr uint8_t kAir = 0, kShell = 1, kFirstColour = 2, kColours = 126;
constexpr uint8_t kCutAway = 128;  // added to what was there

struct Hit {
    ivec3 cell{0};
    vec3 place{0.0F};
    int axis = -1;   // of the face; -1: none was met
    float side = 0;  // where its normal points along it
};

// What is drawn: one byte a cell, of one voxel or of a block of several.
class Cells {
  public:
    Cells(const VoxelLabels& labels, bool cutOpen) {
        const int longest = std::max(labels.size.x, std::max(labels.size.y, labels.size.z));
        const int block = (longest + kMostCells - 1) / kMostCells;
        size_ = (labels.size + ivec3(block - 1)) / block;
        bricks_ = (size_ + ivec3(kBrick - 1)) / kBrick;
        cells_.assign(volume(size_), kAir);
        tbb::parallel_for(0, size_.z, [&](int z) {
            for (int y = z * block; y < std::min((z + 1) * block, labels.size.z); ++y) fill(labels, y, block);
        });
        low = size_;
        forAll([this](const ivec3& c, uint8_t& cell) {
            if (cell == kAir) return;
            low = glm::min(low, c);
            high = glm::max(high, c + 1);
        });
        if (high.x == 0) low = ivec3(0), high = size_;
        const ivec3 cut = cutOpen ? (low + high) / 2 : high;
        full_.assign(volume(bricks_), 0);
        forAll([this, &cut](const ivec3& c, uint8_t& cell) {
            if (cell == kAir) return;
            if (c.x >= cut.x && c.z >= cut.z)
                cell |= kCutAway;
            else
                full_[index(bricks_, c / kBrick)] = 1;
        });
    }

    ivec3 low{0}, high{0};  // of what is not air

    // What is there, or was before the cut.
    uint8_t at(const ivec3& c) const { return inside(c) ? cells_[index(size_, c)] & (kCutAway - 1) : kAir; }
    bool cutAway(const ivec3& c) const { return inside(c) && cells_[index(size_, c)] > kCutAway; }

    // The first cell on the way, in cells; axis -1: none. Cells are stepped as whole numbers, so rounding can neither skip nor repeat one.
    Hit trace(const vec3& from, const vec3& way) const {
        Hit hit;
        vec3 per;  // t a cell
        ivec3 step;
        float t = 0, end = std::numeric_limits<float>::max();
        for (int k = 0; k < 3; ++k) {
            step[k] = way[k] < 0 ? -1 : 1;
            per[k] = 1.0F / (std::abs(way[k]) < 1e-12F ? static_cast<float>(step[k]) * 1e-12F : way[k]);
            const float a = -from[k] * per[k], b = (static_cast<float>(size_[k]) - from[k]) * per[k];
            if (std::min(a, b) > t) {
                t = std::min(a, b);
                hit.axis = k;
            }
            end = std::min(end, std::max(a, b));
        }
        if (t >= end) return Hit{};
        std::array<size_t, 3> stride{1, static_cast<size_t>(size_.x), static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y)};
        for (size_t k = 0; k < 3; ++k) stride[k] *= static_cast<size_t>(static_cast<std::ptrdiff_t>(step[static_cast<int>(k)]));
        ivec3 cell = cellAt(from + way * t, ivec3(0), size_ - 1);
        while (inside(cell)) {
            const ivec3 first = cell / kBrick * kBrick, last = glm::min(first + (kBrick - 1), size_ - 1);
            const bool empty = full_[index(bricks_, cell / kBrick)] == 0;
            if (empty) {
                int out = 0;
                t = std::numeric_limits<float>::max();
                for (int k = 0; k < 3; ++k) {
                    const float there = (static_cast<float>(step[k] > 0 ? last[k] + 1 : first[k]) - from[k]) * per[k];
                    if (there < t) {
                        t = there;
                        out = k;
                    }
                }
                cell = cellAt(from + way * t, first, last);
                cell[out] = step[out] > 0 ? last[out] + 1 : first[out] - 1;
                hit.axis = out;
                continue;
            }
            vec3 next;
            ivec3 left;  // cells until the brick ends
            for (int k = 0; k < 3; ++k) {
                next[k] = (static_cast<float>(step[k] > 0 ? cell[k] + 1 : cell[k]) - from[k]) * per[k];
                left[k] = step[k] > 0 ? last[k] - cell[k] : cell[k] - first[k];
            }
            for (size_t at = index(size_, cell);;) {
                if (static_cast<uint8_t>(cells_[at] - 1) < kCutAway - 1) {
                    hit.cell = cell;
                    hit.place = from + way * t;
                    if (hit.axis < 0) hit.axis = 1;  // it began inside
                    hit.side = static_cast<float>(-step[hit.axis]);
                    return hit;
                }
                const int k = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
                t = next[k];
                hit.axis = k;
                cell[k] += step[k];
                if (left[k]-- == 0) break;
                next[k] += std::abs(per[k]);
                at += stride[static_cast<size_t>(k)];
            }
        }
        return Hit{};
    }

    // From the solid to the air around a cell, over the two next cells each way; zero amid a plane cloud.
    vec3 smoothNormal(const ivec3& c) const {
        vec3 sum(0.0F);
        for (int z = -2; z <= 2; ++z) {
            for (int y = -2; y <= 2; ++y) {
                for (int x = -2; x <= 2; ++x) {
                    if (at(c + ivec3(x, y, z)) == kAir) sum += vec3(x, y, z);
                }
            }
        }
        return sum;
    }

  private:
    static size_t volume(const ivec3& s) { return static_cast<size_t>(s.x) * static_cast<size_t>(s.y) * static_cast<size_t>(s.z); }
    static size_t index(const ivec3& s, const ivec3& c) {
        return (static_cast<size_t>(c.z) * static_cast<size_t>(s.y) + static_cast<size_t>(c.y)) * static_cast<size_t>(s.x) +
               static_cast<size_t>(c.x);
    }
    bool inside(const ivec3& c) const { return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < size_.x && c.y < size_.y && c.z < size_.z; }
    template <class Fn>
    void forAll(const Fn& fn) {
        for (int z = 0; z < size_.z; ++z) {
            for (int y = 0; y < size_.y; ++y) {
                for (int x = 0; x < size_.x; ++x) fn(ivec3(x, y, z), cells_[index(size_, {x, y, z})]);
            }
        }
    }
    static ivec3 cellAt(const vec3& p, const ivec3& least, const ivec3& most) { return glm::clamp(ivec3(glm::floor(p)), least, most); }
    // Layer `z` of the voxels into the cells: of a block's voxels the surface wins, then any material.
    void fill(const VoxelLabels& labels, int z, int block) {
        for (int y = 0; y < labels.size.y; ++y) {
            const std::span<const LabelRun> runs = labels.row(y, z);
            uint8_t* row = &cells_[index(size_, {0, y / block, z / block})];
            for (size_t k = 0; k < runs.size(); ++k) {
                const uint32_t label = runs[k].label;
                if (label == kOutside || (label >= kFirstMaterial && !labels.materials[label - kFirstMaterial].solid)) continue;
                const auto kind =
                    label == kInsideSurface ? kShell : static_cast<uint8_t>(kFirstColour + (label - kFirstMaterial) % kColours);
                const uint32_t last = (k + 1 < runs.size() ? runs[k + 1].x : static_cast<uint32_t>(labels.size.x)) - 1;
                for (uint32_t x = runs[k].x / static_cast<uint32_t>(block); x <= last / static_cast<uint32_t>(block); ++x) {
                    if (row[x] == kAir || kind == kShell) row[x] = kind;
                }
            }
        }
    }

    ivec3 size_{0}, bricks_{0};
    std::vector<uint8_t> cells_, full_;
};

// Numbers in 0..1 for one sample of one pixel: spread evenly over the samples (Roberts 2018), and moved by a hash of the pixel.
class Numbers {
  public:
    Numbers(int x, int y, int sample) : sample_(static_cast<double>(sample)) {
        state_ = static_cast<uint32_t>(x) * 73856093U ^ static_cast<uint32_t>(y) * 19349663U ^ 0x9E3779B9U;
    }
    vec2 next() {
        constexpr double kA = 0.7548776662466927, kB = 0.5698402909980532;
        const double x = hash() + kA * sample_, y = hash() + kB * sample_;
        return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
    }

  private:
    double hash() {  // Jarzynski and Olano 2020, pcg
        state_ = state_ * 747796405U + 2891336453U;
        uint32_t word = ((state_ >> ((state_ >> 28U) + 4U)) ^ state_) * 277803737U;
        word = (word >> 22U) ^ word;
        return static_cast<double>(word) / 4294967296.0;
    }
    double sample_;
    uint32_t state_;
};

// A direction about unit `n`: denser towards it, as light falls on a wall.
vec3 aboutNormal(const vec3& n, const vec2& random) {
    const float angle = 2 * kPi * random.x, z = 2 * random.y - 1, r = std::sqrt(std::max(0.0F, 1 - z * z));
    const vec3 sum = n + 0.999F * vec3(r * std::cos(angle), r * std::sin(angle), z);
    return glm::normalize(sum);
}

class View {
  public:
    View(const VoxelLabels& labels, const VoxelViewOptions& options) : options_(options), cells_(labels, options.cutOpen) {
        for (uint32_t k = 0; k < kColours; ++k) colours_.push_back(materialColour(k));
        const vec3 low(cells_.low), high(cells_.high);
        floor_ = low.y;
        const vec3 target = 0.5F * (low + high);
        forward_ = -glm::normalize(vec3(0.62F, 0.50F, 0.78F));
        right_ = glm::normalize(glm::cross(forward_, vec3(0, 1, 0)));
        up_ = glm::cross(right_, forward_);
        // As near as the box's corners allow: each must lie inside the picture less its margin, which is a plane for each of four sides.
        const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
        tall_ = std::tan(0.5F * 26 * kPi / 180);
        wide_ = tall_ * aspect;
        constexpr float kFill = 0.90F;
        vec2 shift(0.0F);
        float distance = 0;
        for (int round = 0; round < 8; ++round) {  // the margins become equal by and by
            const vec3 aim = target + shift.x * right_ + shift.y * up_;
            distance = 0;
            for (int k = 0; k < 8; ++k) {
                const vec3 q = corner(low, high, k) - aim;
                const float across = std::abs(glm::dot(q, right_)) / (kFill * wide_), along = std::abs(glm::dot(q, up_)) / (kFill * tall_);
                distance = std::max(distance, std::max(across, along) - glm::dot(q, forward_));
            }
            vec2 least(1e9F), most(-1e9F);
            for (int k = 0; k < 8; ++k) {
                const vec3 q = corner(low, high, k) - aim;
                const float depth = distance + glm::dot(q, forward_);
                const vec2 at(glm::dot(q, right_) / depth, glm::dot(q, up_) / depth);
                least = glm::min(least, at);
                most = glm::max(most, at);
            }
            shift += 0.5F * (least + most) * distance;
            eye_ = aim - distance * forward_;
        }
    }

    VoxelPicture draw() const {
        VoxelPicture picture{options_.width, options_.height, {}};
        picture.rgba.resize(4 * static_cast<size_t>(options_.width) * static_cast<size_t>(options_.height));
        constexpr int kTile = 16;
        tbb::parallel_for(tbb::blocked_range2d<int>(0, options_.height, kTile, 0, options_.width, kTile), [&](const auto& tile) {
            for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
                for (int x = tile.cols().begin(); x < tile.cols().end(); ++x) {
                    const uint32_t bytes = srgbBytes(pixel(x, y));
                    const size_t at = 4 * (static_cast<size_t>(y) * static_cast<size_t>(options_.width) + static_cast<size_t>(x));
                    for (size_t k = 0; k < 4; ++k) picture.rgba[at + k] = static_cast<uint8_t>(bytes >> (8 * k));
                }
            }
        });
        return picture;
    }

  private:
    // Of a pixel's samples so far.
    struct Kept {
        bool open = true;  // none met a voxel or the ground near them
        ivec3 cell{-1};
        vec3 smooth{0.0F};  // of that cell
    };

    static vec3 corner(const vec3& low, const vec3& high, int k) {
        return {(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y, (k & 4) != 0 ? high.z : low.z};
    }

    vec3 pixel(int x, int y) const {
        vec3 sum(0.0F);
        Kept kept;
        int taken = 0;
        // A few samples tell that there is only open ground.
        for (; taken < options_.samples && (taken < 4 || !kept.open); ++taken) {
            Numbers numbers(x, y, taken);
            const vec2 jitter = numbers.next();
            const float across = (2 * (static_cast<float>(x) + jitter.x) / static_cast<float>(options_.width) - 1) * wide_;
            const float along = (1 - 2 * (static_cast<float>(y) + jitter.y) / static_cast<float>(options_.height)) * tall_;
            sum += seen(glm::normalize(forward_ + across * right_ + along * up_), numbers, kept, vec2(across / wide_, along / tall_));
        }
        return sum / static_cast<float>(std::max(taken, 1));
    }

    vec3 seen(const vec3& way, Numbers& numbers, Kept& kept, const vec2& screen) const {
        const Hit hit = cells_.trace(eye_, way);
        if (hit.axis >= 0) {
            kept.open = false;
            vec3 face(0.0F);
            face[hit.axis] = hit.side;
            ivec3 before = hit.cell;
            before[hit.axis] += static_cast<int>(hit.side);
            const uint8_t kind = cells_.at(hit.cell);
            const bool cut = cells_.cutAway(before);
            vec3 normal = face;
            if (!cut) {
                if (hit.cell != kept.cell) {
                    kept.cell = hit.cell;
                    kept.smooth = cells_.smoothNormal(hit.cell);
                }
                const vec3 smooth = kept.smooth;
                const float length = glm::length(smooth);
                if (length > 1.0F) normal = glm::normalize(0.35F * face + smooth / length);
            }
            const vec3 colour = kind != kShell ? colours_[kind - kFirstColour] : cut ? kCutShell : kClay;
            return colour * light(hit.place + 0.02F * face, face, normal, numbers);
        }
        const vec3 backdrop = kGround * (1.0F - 0.06F * glm::dot(screen, screen));
        if (way.y >= 0) return backdrop;
        const vec3 place = eye_ + way * ((floor_ - eye_.y) / way.y);
        // The ground is as pale as the backdrop but where something keeps the light from it.
        const vec3 up(0, 1, 0);
        const float dark = nearness(place);
        if (!(dark > 0)) return backdrop;
        const vec3 lit = light(place + 0.02F * up, up, up, numbers);
        kept.open = false;
        return backdrop * mix3(vec3(1.0F), glm::min(lit / kOpenLight, vec3(1.0F)), dark);
    }

    // 1 on the ground near the voxels, 0 so far away that little light is kept from it there.
    float nearness(const vec3& place) const {
        const vec3 low(cells_.low), high(cells_.high), size = high - low;
        const vec3 beside = glm::max(vec3(0.0F), glm::max(low - place, place - high));
        const float away = glm::length(vec2(beside.x, beside.z)) / std::max(size.x, std::max(size.y, size.z));
        return std::clamp((0.85F - away) / 0.35F, 0.0F, 1.0F);
    }

    vec3 light(const vec3& place, const vec3& face, const vec3& normal, Numbers& numbers) const {
        vec3 sum(0.0F);
        const vec3 way = aboutNormal(normal, numbers.next());
        if (glm::dot(way, face) > 0) {
            const Hit hit = cells_.trace(place, way);
            if (hit.axis >= 0)
                sum += kBounce;
            else if (way.y >= 0)
                sum += sky(way);
            else
                sum += kGroundLight;
        }
        const vec3 toSun = glm::normalize(sun_ + 0.09F * aboutNormal(sun_, numbers.next()));
        const float facing = glm::dot(normal, toSun);
        if (facing > 0 && glm::dot(face, toSun) > 0 && cells_.trace(place, toSun).axis < 0) sum += kSunLight * facing;
        return sum;
    }

    static vec3 sky(const vec3& way) { return mix3(vec3(0.62F, 0.64F, 0.66F), vec3(0.70F, 0.76F, 0.84F), way.y); }
    static vec3 mix3(const vec3& a, const vec3& b, float t) { return a + (b - a) * t; }

    static constexpr vec3 kClay{0.70F, 0.665F, 0.61F}, kCutShell{0.045F, 0.055F, 0.07F}, kGround{0.90F, 0.895F, 0.88F};
    static constexpr vec3 kBounce{0.16F, 0.15F, 0.14F}, kGroundLight{0.42F, 0.41F, 0.40F}, kSunLight{0.80F, 0.74F, 0.64F};
    static constexpr vec3 kOpenLight{1.22F, 1.21F, 1.20F};  // on the ground with nothing around
    vec3 sun_ = glm::normalize(vec3(-0.35F, 0.80F, 0.48F));

    VoxelViewOptions options_;
    Cells cells_;
    std::vector<vec3> colours_;
    vec3 eye_{0.0F}, forward_{0.0F}, right_{0.0F}, up_{0.0F};
    float wide_ = 0, tall_ = 0, floor_ = 0;
};

}  // namespace

VoxelPicture drawVoxels(const VoxelLabels& labels, const VoxelViewOptions& options) { return View(labels, options).draw(); }

}  // namespace rivulet
