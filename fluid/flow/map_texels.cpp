#include "fluid/flow/map_texels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "fluid/flow/skin_folds.h"
#include "fluid/flow/uv_triangle.h"
#include "shaders/flow/map_step.h"

namespace rivulet {

namespace {

// Squared distance of a point from a triangle, 0 inside.
double outside(const UvTriangle& f, const dvec2& x) {
    bool inside = true;
    double least = 1.0e300;
    for (size_t k = 0; k < 3; ++k) {
        const dvec2 a = f.p[k], e = f.p[(k + 1) % 3] - a;
        if (cross2(e, x - a) * f.area < 0) inside = false;
        const double share = std::clamp(glm::dot(x - a, e) / glm::dot(e, e), 0.0, 1.0);
        const dvec2 d = a + share * e - x;
        least = std::min(least, glm::dot(d, d));
    }
    return inside ? 0 : least;
}

class Rasteriser {
  public:
    Rasteriser(const FlowMesh& mesh, std::span<const vec2> uvs, int size)
        : size_(size), words_(static_cast<size_t>(size) * static_cast<size_t>(size), TEXEL_NONE) {
        flats_.reserve(mesh.triangleCount());
        for (size_t t = 0; t < mesh.triangleCount(); ++t) flats_.push_back(uvTriangle(uvs.subspan(3 * t, 3), size));
        for (uint32_t t = 0; t < flats_.size(); ++t)
            if (flats_[t].good()) fill(t);
        inside_ = std::count_if(words_.begin(), words_.end(), [](uint32_t w) { return w != TEXEL_NONE; });
        // A chart smaller than a texel still gets one.
        std::vector<bool> shown(flats_.size(), false);
        for (const uint32_t w : words_)
            if (w != TEXEL_NONE) shown[w & TEXEL_TRIANGLE] = true;
        for (uint32_t t = 0; t < flats_.size(); ++t)
            if (flats_[t].good() && !shown[t]) {
                const dvec2 middle = flats_[t].middle();
                claim(static_cast<int>(std::lround(middle.x)), static_cast<int>(std::lround(middle.y)), t);
            }
    }

    // Ring by ring about the charts: each texel takes the nearest of the triangles beside it.
    void grow(int rings) {
        std::vector<uint32_t> front;
        for (uint32_t at = 0; at < words_.size(); ++at)
            if (words_[at] != TEXEL_NONE) front.push_back(at);
        for (int ring = 0; ring < rings; ++ring) {
            std::vector<std::pair<uint32_t, uint32_t>> taken;
            std::vector<uint32_t> next;
            for (const uint32_t at : front) {
                const int x = static_cast<int>(at) % size_, y = static_cast<int>(at) / size_;
                for (int k = 0; k < 9; ++k) {
                    const uint32_t beside = index(wrapped(x + k % 3 - 1), wrapped(y + k / 3 - 1));
                    if (words_[beside] == TEXEL_NONE) next.push_back(beside);
                }
            }
            std::sort(next.begin(), next.end());
            next.erase(std::unique(next.begin(), next.end()), next.end());
            for (const uint32_t at : next)
                if (const uint32_t word = nearestBeside(at); word != TEXEL_NONE) taken.emplace_back(at, word);
            front.clear();
            for (const auto& [at, word] : taken) {
                words_[at] = word;
                front.push_back(at);
            }
        }
    }

    const std::vector<uint32_t>& words() const { return words_; }
    const std::vector<UvTriangle>& flats() const { return flats_; }
    size_t inside() const { return static_cast<size_t>(inside_); }

  private:
    int wrapped(int x) const { return (x % size_ + size_) % size_; }
    uint32_t index(int x, int y) const { return static_cast<uint32_t>(y) * static_cast<uint32_t>(size_) + static_cast<uint32_t>(x); }
    int turnsOf(int x) const { return (x - wrapped(x)) / size_; }
    uint32_t wordOf(uint32_t t, int x, int y) const {
        return t | static_cast<uint32_t>(turnsOf(x) + 1) << TEXEL_TURN_U | static_cast<uint32_t>(turnsOf(y) + 1) << TEXEL_TURN_V;
    }
    void claim(int x, int y, uint32_t t) {
        uint32_t& word = words_[index(wrapped(x), wrapped(y))];
        if (word == TEXEL_NONE) word = wordOf(t, x, y);
    }

    void fill(uint32_t t) {
        eachCentre(flats_[t], 1.0e-9, [&](int x, int y) { claim(x, y, t); });
    }

    uint32_t nearestBeside(uint32_t at) const {
        const int x = static_cast<int>(at) % size_, y = static_cast<int>(at) / size_;
        uint32_t best = TEXEL_NONE;
        double least = 1.0e300;
        for (int k = 0; k < 9; ++k) {
            const int bx = x + k % 3 - 1, by = y + k / 3 - 1;
            const uint32_t beside = words_[index(wrapped(bx), wrapped(by))];
            if (beside == TEXEL_NONE) continue;
            // This texel's place in that triangle's UVs, continued from its neighbour.
            const int ux = x + (static_cast<int>(beside >> TEXEL_TURN_U & 3U) - 1 - turnsOf(bx)) * size_;
            const int uy = y + (static_cast<int>(beside >> TEXEL_TURN_V & 3U) - 1 - turnsOf(by)) * size_;
            if (std::max(ux, uy) >= 2 * size_ || std::min(ux, uy) < -size_) continue;
            const uint32_t t = beside & TEXEL_TRIANGLE;
            const double d = outside(flats_[t], dvec2(ux, uy));
            if (d < least || (d == least && t < (best & TEXEL_TRIANGLE))) {
                least = d;
                best = wordOf(t, ux, uy);
            }
        }
        return best;
    }

    int size_;
    std::vector<uint32_t> words_;
    std::vector<UvTriangle> flats_;
    std::ptrdiff_t inside_ = 0;
};

// Texels of a tile that are connected on the skin are a piece, with a box of its own in space.
class PieceMaker {
  public:
    PieceMaker(const FlowMesh& mesh, const std::vector<UvTriangle>& flats, MapTexels& to)
        : mesh_(mesh), flats_(flats), to_(to), seen_(mesh.rest.size(), UINT32_MAX) {}

    void add(uint32_t tileX, uint32_t tileY, const std::array<uint32_t, TILE_TEXELS>& words) {
        std::array<uint8_t, TILE_TEXELS> piece;
        piece.fill(0);
        uint8_t pieces = 0;
        to_.tile.insert(to_.tile.end(), {tileX | tileY << 16U, static_cast<uint32_t>(to_.pieces())});
        std::vector<uint32_t> open;
        for (uint32_t start = 0; start < TILE_TEXELS; ++start) {
            if (words[start] == TEXEL_NONE || piece[start] != 0) continue;
            piece[start] = ++pieces;
            open.assign(1, start);
            std::vector<uint32_t> members;
            while (!open.empty()) {
                const uint32_t at = open.back();
                open.pop_back();
                members.push_back(at);
                for (uint32_t k = 0; k < 9; ++k) {
                    const uint32_t x = at % 8 + k % 3, y = at / 8 + k / 3;  // one more than they are
                    if (x < 1 || x > 8 || y < 1 || y > 8) continue;
                    const uint32_t beside = (y - 1) * 8 + x - 1;
                    if (words[beside] == TEXEL_NONE || piece[beside] != 0 || !meet(words[at], words[beside])) continue;
                    piece[beside] = pieces;
                    open.push_back(beside);
                }
            }
            pin(tileX * 8, tileY * 8, words, members);
            to_.pinBegin.push_back(static_cast<uint32_t>(to_.pin.size()));
        }
        to_.tile.insert(to_.tile.end(), {static_cast<uint32_t>(to_.pieces()), 0U});
        to_.texel.insert(to_.texel.end(), words.begin(), words.end());
    }

  private:
    bool meet(uint32_t a, uint32_t b) const {
        const uint32_t* ca = &mesh_.corner[3 * size_t{a & TEXEL_TRIANGLE}];
        const uint32_t* cb = &mesh_.corner[3 * size_t{b & TEXEL_TRIANGLE}];
        return std::any_of(ca, ca + 3, [cb](uint32_t place) { return std::find(cb, cb + 3, place) != cb + 3; });
    }

    // A small triangle with no texels outside itself is bounded by its corners, which its neighbours share; another by a triangle with
    // parallel edges about its texels here; a large one by the rectangle about them.
    void pin(uint32_t x0, uint32_t y0, const std::array<uint32_t, TILE_TEXELS>& words, std::vector<uint32_t>& members) {
        std::sort(members.begin(), members.end(),
                  [&](uint32_t a, uint32_t b) { return words[a] != words[b] ? words[a] < words[b] : a < b; });
        const auto stamp = static_cast<uint32_t>(to_.pieces());
        for (size_t first = 0; first < members.size();) {
            const uint32_t word = words[members[first]] & ~TEXEL_FOLD;
            const UvTriangle& f = flats_[word & TEXEL_TRIANGLE];
            const uint32_t* corner = &mesh_.corner[3 * size_t{word & TEXEL_TRIANGLE}];
            uint32_t lowX = 7, highX = 0, lowY = 7, highY = 0;
            std::array<double, 3> least{1.0e9, 1.0e9, 1.0e9};  // of each corner, what its texels have of it
            size_t end = first;
            for (; end < members.size() && (words[members[end]] & ~TEXEL_FOLD) == word; ++end) {
                const uint32_t x = members[end] % 8, y = members[end] / 8;
                lowX = std::min(lowX, x);
                highX = std::max(highX, x);
                lowY = std::min(lowY, y);
                highY = std::max(highY, y);
                const dvec2 turns((word >> TEXEL_TURN_U & 3U), (word >> TEXEL_TURN_V & 3U));
                const dvec2 at = dvec2(x0 + x, y0 + y) + (turns - 1.0) * double(to_.size);
                for (size_t k = 0; k < 3; ++k) {
                    const dvec2 &p = f.p[(k + 1) % 3], &q = f.p[(k + 2) % 3];
                    least[k] = std::min(least[k], cross2(q - p, at - p) / f.area);
                }
            }
            first = end;
            const dvec2 span = f.high() - f.low();
            const double outermost = std::min({least[0], least[1], least[2]});
            if (outermost > -1.0e-6 && std::max(span.x, span.y) < 8) {
                for (size_t k = 0; k < 3; ++k) {
                    if (seen_[corner[k]] == stamp) continue;
                    seen_[corner[k]] = stamp;
                    to_.pin.push_back(corner[k]);
                }
            } else if (outermost > -PIN_MOST && std::max(span.x, span.y) < 32) {
                std::array<uint32_t, 3> share;
                for (size_t k = 0; k < 3; ++k) share[k] = static_cast<uint32_t>(std::floor((least[k] + PIN_MOST) * PIN_PARTS - 0.01));
                to_.pin.insert(to_.pin.end(), {PIN_PART | corner[0], corner[1], corner[2], share[0] | share[1] << 16U, share[2]});
            } else
                to_.pin.insert(to_.pin.end(),
                               {PIN_RECT | word, (x0 + lowX) | (y0 + lowY) << 13U | (highX - lowX) << 26U | (highY - lowY) << 29U});
        }
    }

    const FlowMesh& mesh_;
    const std::vector<UvTriangle>& flats_;
    MapTexels& to_;
    std::vector<uint32_t> seen_;
};

std::vector<vec4> chartsOf(const std::vector<UvTriangle>& flats, std::span<const float> folds, int size) {
    std::vector<vec4> chart;
    chart.reserve(2 * flats.size());
    for (const UvTriangle& f : flats) {
        if (!f.good()) {
            chart.insert(chart.end(), 2, vec4(0.0F));
            continue;
        }
        const dvec2 e1 = f.p[1] - f.p[0], e2 = f.p[2] - f.p[0], middle = f.middle();
        const double scale = size / f.area;
        chart.emplace_back(e2.y * scale, -e1.y * scale, -e2.x * scale, e1.x * scale);
        chart.emplace_back((middle.x + 0.5) / size, (middle.y + 0.5) / size, folds[chart.size() / 2], 0);
    }
    return chart;
}

// The share of skin in the texels of every mip from 1.
std::vector<float> coverOf(const std::vector<uint32_t>& words, int size) {
    std::vector<float> cover, above(words.size());
    for (size_t k = 0; k < words.size(); ++k) above[k] = words[k] == TEXEL_NONE ? 0.0F : 1.0F;
    for (auto edge = static_cast<size_t>(size) / 2; edge >= 1; edge /= 2) {
        std::vector<float> level(edge * edge);
        for (size_t y = 0; y < edge; ++y)
            for (size_t x = 0; x < edge; ++x) {
                const float* a = &above[4 * y * edge + 2 * x];
                level[y * edge + x] = 0.25F * (a[0] + a[1] + a[2 * edge] + a[2 * edge + 1]);
            }
        cover.insert(cover.end(), level.begin(), level.end());
        above.swap(level);
    }
    return cover;
}

}  // namespace

MapTexels layTexels(const FlowMesh& mesh, std::span<const vec2> uvs, std::span<const float> folds, int size, int gutter) {
    Rasteriser raster(mesh, uvs, size);
    raster.grow(gutter);
    const std::vector<uint32_t>& words = raster.words();
    MapTexels map;
    map.size = size;
    map.inside = raster.inside();
    map.pinBegin.push_back(0);
    PieceMaker pieces(mesh, raster.flats(), map);
    const auto tiles = static_cast<uint32_t>(size) / 8, edge = static_cast<uint32_t>(size);
    for (uint32_t ty = 0; ty < tiles; ++ty)
        for (uint32_t tx = 0; tx < tiles; ++tx) {
            std::array<uint32_t, TILE_TEXELS> own;
            bool any = false;
            for (uint32_t k = 0; k < TILE_TEXELS; ++k) {
                uint32_t word = words[size_t{ty * 8 + k / 8} * edge + tx * 8 + k % 8];
                if (word != TEXEL_NONE) {
                    any = true;
                    if (folds[word & TEXEL_TRIANGLE] < kNoFold) word |= TEXEL_FOLD;
                }
                own[k] = word;
            }
            if (any) pieces.add(tx, ty, own);
        }
    map.chart = chartsOf(raster.flats(), folds, size);
    map.cover = coverOf(words, size);
    return map;
}

std::vector<uint32_t> packTexels(MapTexels& map, std::span<const uint32_t> taps) {
    std::vector<uint32_t> packed, words, cells, blocks;
    for (size_t tile = 0; tile < map.tiles(); ++tile) {
        words.clear();
        cells.clear();
        for (size_t k = tile * TILE_TEXELS; k < (tile + 1) * TILE_TEXELS; ++k) {
            if (map.texel[k] == TEXEL_NONE) continue;
            words.push_back(map.texel[k]);
            cells.insert(cells.end(), {taps[3 * k], taps[3 * k + 1], taps[3 * k + 2]});
        }
        for (std::vector<uint32_t>* names : {&words, &cells}) {
            std::sort(names->begin(), names->end());
            names->erase(std::unique(names->begin(), names->end()), names->end());
        }
        // Most cells lie side by side: groups of four that begin at an even cell, where one byte numbers each cell.
        uint32_t shift = 2;
        const auto lay = [&] {
            blocks.clear();
            for (const uint32_t cell : cells)
                if (blocks.empty() || cell - blocks.back() >= 1U << shift) blocks.push_back(shift > 0 ? cell & ~1U : cell);
        };
        lay();
        if (blocks.size() > 64) {
            shift = 0;
            lay();
        }
        const auto numberOf = [&](uint32_t cell) {
            const auto block = std::upper_bound(blocks.begin(), blocks.end(), cell) - blocks.begin() - 1;
            return (static_cast<uint32_t>(block) << shift) + cell - blocks[static_cast<size_t>(block)];
        };
        map.tile[TILE_UINTS * tile + 3] = static_cast<uint32_t>(packed.size());
        for (size_t k = tile * TILE_TEXELS; k < (tile + 1) * TILE_TEXELS; ++k)
            packed.push_back(map.texel[k] == TEXEL_NONE
                                 ? PACKED_NONE
                                 : static_cast<uint32_t>(std::lower_bound(words.begin(), words.end(), map.texel[k]) - words.begin()) |
                                       numberOf(taps[3 * k]) << 8U | numberOf(taps[3 * k + 1]) << 16U | numberOf(taps[3 * k + 2]) << 24U);
        packed.push_back(static_cast<uint32_t>(words.size()) | static_cast<uint32_t>(blocks.size()) << PACKED_BLOCKS |
                         (shift > 0 ? PACKED_FOURS : 0));
        packed.insert(packed.end(), words.begin(), words.end());
        packed.insert(packed.end(), blocks.begin(), blocks.end());
    }
    return packed;
}

SkinPoint skinPointOf(const MapTexels& map, uint32_t word, int x, int y) {
    const uint32_t t = word & TEXEL_TRIANGLE;
    const vec4 slope = map.chart[2 * size_t{t}], middle = map.chart[2 * size_t{t} + 1];
    const auto size = static_cast<float>(map.size);
    const float u = (static_cast<float>(x) + 0.5F) / size + static_cast<float>(word >> TEXEL_TURN_U & 3U) - 1 - middle.x;
    const float v = (static_cast<float>(y) + 0.5F) / size + static_cast<float>(word >> TEXEL_TURN_V & 3U) - 1 - middle.y;
    return {t, 1.0F / 3 + slope.x * u + slope.z * v, 1.0F / 3 + slope.y * u + slope.w * v};
}

}  // namespace rivulet
