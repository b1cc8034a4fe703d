// The view from outside: rays through the grid, voxel by voxel near solid voxels (Amanatides and Woo 1987), one brick of 16^3
// at a time in empty space. Light from the whole sky and one soft sun, also by rays: a few per pixel, shared among pixels of one face
// (interleaved sampling, Keller and Heidrich 2001).

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "engine/core/parallel.h"
#include "fluid/voxel/voxel_picture.h"

namespace rivulet {
namespace {

constexpr int kMostCells = 512;
constexpr int kSkippedBrick = 16;  // cells; the fastest of 4, 8 and 16

constexpr uint8_t kAir = 0, kShell = 1, kFirstColour = 2, kColours = 126;
constexpr uint8_t kCutAway = 128;  // added to the previous value

// Pixels of the picture.
struct Tile {
    ivec2 low, size;
};

struct Hit {
    ivec3 cell{0};
    vec3 place{0.0F};
    int axis = -1;   // of the face; -1: no hit
    float side = 0;  // direction of its normal along the axis
};

// The drawn cells, one byte each: one voxel, or a block of several.
class Cells {
  public:
    Cells(const VoxelLabels& labels, bool cutOpen) {
        const int longest = std::max(labels.size.x, std::max(labels.size.y, labels.size.z));
        const int block = (longest + kMostCells - 1) / kMostCells;
        size_ = (labels.size + ivec3(block - 1)) / block;
        bricks_ = (size_ + ivec3(kSkippedBrick - 1)) / kSkippedBrick;
        cells_.assign(volume(size_), kAir);
        parallelFor(0, size_.z, [&](int z) {
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
                full_[index(bricks_, c / kSkippedBrick)] = 1;
        });
    }

    ivec3 low{0}, high{0};  // of the cells that are not air

    // The content of a cell, also before the cut.
    uint8_t at(const ivec3& c) const { return inside(c) ? cells_[index(size_, c)] & (kCutAway - 1) : kAir; }
    bool cutAway(const ivec3& c) const { return inside(c) && cells_[index(size_, c)] > kCutAway; }

    // The first cell that the ray hits; axis -1: none. Steps between cells are integers, so rounding can neither skip nor repeat a cell.
    Hit trace(const vec3& from, const vec3& way) const {
        Hit hit;
        vec3 per;  // t per cell
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
            const ivec3 first = cell / kSkippedBrick * kSkippedBrick, last = glm::min(first + (kSkippedBrick - 1), size_ - 1);
            const bool empty = full_[index(bricks_, cell / kSkippedBrick)] == 0;
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
                    if (hit.axis < 0) hit.axis = 1;  // the ray began inside
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

    // Direction from solid to air around a cell, over two cells each way; zero inside a uniform region.
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
    // Copies layer `z` of the voxels into the cells: in a block the surface has priority, then any material.
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

// Numbers in 0..1 for one sample of one pixel. A tile of kNear x kNear pixels and their samples share one even sequence (Roberts 2018), so
// that the average over a pixel's neighbours is as smooth as if each pixel had sent all rays of its tile.
constexpr int kNear = 6;
constexpr int kMostSamples = 64;
class Numbers {
  public:
    Numbers(int x, int y, int sample) {
        // The tile's pixels in a scattered order, 36 and 23 having no factor in common: neighbours should differ much.
        const int place = (x % kNear + kNear * (y % kNear)) * 23 % (kNear * kNear);
        number_ = static_cast<double>(place + kNear * kNear * sample);
    }
    vec2 next() {
        constexpr double kA = 0.7548776662466927, kB = 0.5698402909980532;
        offset_ += 0.3819660112501051;
        const double x = offset_ + kA * number_, y = 2 * offset_ + kB * number_;
        return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
    }

  private:
    double number_, offset_ = 0;
};

// A cosine-weighted direction about unit `n`.
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
        // The camera is as near as the box's corners allow: each must lie inside the picture without its margin (four planes).
        const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
        tall_ = std::tan(0.5F * 26 * kPi / 180);
        wide_ = tall_ * aspect;
        constexpr float kFill = 0.90F;
        vec2 shift(0.0F);
        float distance = 0;
        for (int round = 0; round < 8; ++round) {  // the margins converge to equal values
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

    // First pass: hits of each pixel, with few light samples. Second pass: neighbours on the same face share their light.
    VoxelPicture draw() const {
        std::vector<Pixel> pixels(static_cast<size_t>(options_.width) * static_cast<size_t>(options_.height));
        const float unit = 2 * tall_ / static_cast<float>(options_.height);
        Steps steps(options_);
        forTiles([&](const auto& tile) {
            Kept kept;
            forPixels(tile, [&](int x, int y) { pixels[at(x, y)] = look(x, y, kept, unit); });
            steps.done(tile, 0.85);
        });
        VoxelPicture picture{options_.width, options_.height, {}};
        picture.rgba.resize(4 * pixels.size());
        forTiles([&](const auto& tile) {
            forPixels(tile, [&](int x, int y) {
                const Pixel& pixel = pixels[at(x, y)];
                const uint32_t bytes = srgbBytes(pixel.kind == kMixed ? pixel.colour : shaded(pixel, lightNear(pixels, x, y, unit)));
                for (size_t k = 0; k < 4; ++k) picture.rgba[4 * at(x, y) + k] = static_cast<uint8_t>(bytes >> (8 * k));
            });
            steps.done(tile, 0.15);
        });
        return picture;
    }

  private:
    static constexpr int kMixed = -2, kOpen = -1, kFloor = 0;  // above 0: the kind of voxel, and whether it is cut

    struct Seen {
        vec3 colour{0.0F}, light{0.0F}, normal{0.0F}, place{0.0F};
        int kind = kOpen;
    };
    using Pixel = Seen;  // the mean of its samples; for kind kMixed, `colour` is the result

    // The smooth normal of the cell hit last.
    struct Kept {
        ivec3 cell{-1};
        vec3 smooth{0.0F};
    };

    // Share of the work done.
    class Steps {
      public:
        explicit Steps(const VoxelViewOptions& options) : options_(options) {}
        void done(const Tile& tile, double weight) {
            if (!options_.progress) return;
            const std::scoped_lock one(mutex_);
            share_ += weight * static_cast<double>(tile.size.x) * static_cast<double>(tile.size.y) /
                      (static_cast<double>(options_.width) * static_cast<double>(options_.height));
            options_.progress(std::min(share_, 1.0));
        }

      private:
        const VoxelViewOptions& options_;
        std::mutex mutex_;
        double share_ = 0;
    };

    static vec3 corner(const vec3& low, const vec3& high, int k) {
        return {(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y, (k & 4) != 0 ? high.z : low.z};
    }

    size_t at(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(options_.width) + static_cast<size_t>(x); }

    template <class Body>
    void forTiles(const Body& body) const {
        constexpr int kTile = 16;
        const ivec2 all(options_.width, options_.height), tiles = (all + kTile - 1) / kTile;
        parallelFor(0, tiles.x * tiles.y, [&](int k) {
            const ivec2 low = kTile * ivec2(k % tiles.x, k / tiles.x);
            body(Tile{low, glm::min(ivec2(kTile), all - low)});
        });
    }
    template <class Body>
    static void forPixels(const Tile& tile, const Body& body) {
        for (int y = tile.low.y; y < tile.low.y + tile.size.y; ++y)
            for (int x = tile.low.x; x < tile.low.x + tile.size.x; ++x) body(x, y);
    }

    Pixel look(int x, int y, Kept& kept, float unit) const {
        std::array<Seen, kMostSamples> seen;
        const int few = std::clamp(options_.samples, 1, kMostSamples), many = std::min(5 * few / 2, kMostSamples);
        const int lit = (few + 1) / 2;  // rays of the first few that also sample light; neighbours share their light
        int taken = 0;
        const auto take = [&](int to) {
            for (; taken < to; ++taken) {
                Numbers numbers(x, y, taken);
                const vec2 jitter = numbers.next();
                const float across = (2 * (static_cast<float>(x) + jitter.x) / static_cast<float>(options_.width) - 1) * wide_;
                const float along = (1 - 2 * (static_cast<float>(y) + jitter.y) / static_cast<float>(options_.height)) * tall_;
                seen[static_cast<size_t>(taken)] = sample(glm::normalize(forward_ + across * right_ + along * up_), numbers, kept,
                                                          vec2(across / wide_, along / tall_), taken < lit || taken >= few);
            }
        };
        take(few);
        Pixel mean;
        bool calm = true;
        for (int k = 0; k < few; ++k) {
            const Seen& s = seen[static_cast<size_t>(k)];
            calm = calm && alike(seen[0], s, 2 * unit * glm::distance(eye_, seen[0].place));
            mean.colour += s.colour;
            mean.light += s.light;
            mean.normal += s.normal;
            mean.place += s.place;
        }
        if (calm) {
            const auto n = static_cast<float>(few);
            return {mean.colour / n, mean.light / static_cast<float>(lit), mean.normal / n, mean.place / n, seen[0].kind};
        }
        // An edge: more rays, without light of neighbours.
        take(many);
        vec3 sum(0.0F);
        Seen floor;
        float onFloor = 0;
        for (int k = 0; k < many; ++k) {
            if (k == lit) k = few;
            const Seen& s = seen[static_cast<size_t>(k)];
            if (s.kind == kFloor) {
                floor.colour += s.colour;
                floor.light += s.light;
                floor.place += s.place;
                onFloor += 1;
            } else {
                sum += shaded(s, s.light);
            }
        }
        if (onFloor > 0) sum += onFloor * shaded({floor.colour / onFloor, {}, {}, floor.place / onFloor, kFloor}, floor.light / onFloor);
        mean.colour = sum / static_cast<float>(many - few + lit);
        mean.kind = kMixed;
        return mean;
    }

    // True if two places are on one face for the purpose of light; `size`: allowed distance, in cells.
    static bool alike(const Seen& a, const Seen& b, float size) {
        if (a.kind != b.kind) return false;
        if (a.kind <= kFloor) return true;
        const vec3 turn = a.normal - b.normal;
        const float closeness = size > 1.0F ? 0.3F : 0.04F;  // faces of voxels smaller than pixels are not distinguished
        return glm::dot(turn, turn) < closeness && std::abs(glm::dot(a.place - b.place, a.normal)) < std::max(0.4F, 2 * size);
    }

    vec3 lightNear(const std::vector<Pixel>& pixels, int x, int y, float unit) const {
        const Pixel& here = pixels[at(x, y)];
        if (here.kind == kOpen) return here.light;
        const float size = 2 * unit * glm::distance(eye_, here.place);
        const int x0 = std::max(x - (kNear / 2 - 1), 0), x1 = std::min(x + kNear / 2, options_.width - 1);
        const int y0 = std::max(y - (kNear / 2 - 1), 0), y1 = std::min(y + kNear / 2, options_.height - 1);
        vec3 sum(0.0F);
        float weight = 0;
        for (int v = y0; v <= y1; ++v) {
            for (int u = x0; u <= x1; ++u) {
                const Pixel& there = pixels[at(u, v)];
                if (!alike(here, there, size)) continue;
                sum += there.light;
                weight += 1;
            }
        }
        return sum / std::max(weight, 1.0F);
    }

    vec3 shaded(const Seen& s, const vec3& light) const {
        if (s.kind == kOpen) return s.colour;
        if (s.kind != kFloor) return s.colour * light;
        // The ground is as pale as the backdrop, except in shadow.
        return s.colour * mix3(vec3(1.0F), glm::min(light / kOpenLight, vec3(1.0F)), nearness(s.place));
    }

    Seen sample(const vec3& way, Numbers& numbers, Kept& kept, const vec2& screen, bool lit) const {
        const Hit hit = cells_.trace(eye_, way);
        if (hit.axis >= 0) {
            vec3 face(0.0F);
            face[hit.axis] = hit.side;
            ivec3 before = hit.cell;
            before[hit.axis] += static_cast<int>(hit.side);
            const uint8_t kind = cells_.at(hit.cell);
            const bool cut = cells_.cutAway(before);
            vec3 normal = face;
            if (!cut) {
                if (hit.cell != kept.cell) kept = {hit.cell, cells_.smoothNormal(hit.cell)};
                const float length = glm::length(kept.smooth);
                if (length > 1.0F) normal = glm::normalize(0.35F * face + kept.smooth / length);
            }
            const vec3 colour = kind != kShell ? colours_[kind - kFirstColour] : cut ? kCutShell : kClay;
            return {colour, lit ? light(hit.place + 0.02F * face, face, normal, numbers) : vec3(0.0F), normal, hit.place,
                    2 * kind + (cut ? 1 : 0)};
        }
        const vec3 backdrop = kGround * (1.0F - 0.06F * glm::dot(screen, screen));
        if (way.y >= 0) return {backdrop, {}, {}, {}, kOpen};
        const vec3 up(0, 1, 0), place = eye_ + way * ((floor_ - eye_.y) / way.y);
        if (!(nearness(place) > 0)) return {backdrop, {}, {}, {}, kOpen};
        return {backdrop, lit ? light(place + 0.02F * up, up, up, numbers) : vec3(0.0F), up, place, kFloor};
    }

    // 1 on the ground near the voxels, 0 far away, where occlusion is negligible.
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
