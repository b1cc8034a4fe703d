#include "fluid/flow/unwrap.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <queue>

#include "engine/core/assert.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/uv_triangle.h"

#define STBRP_STATIC
#define STB_RECT_PACK_IMPLEMENTATION
#include <stb/stb_rect_pack.h>

namespace rivulet {

namespace {

// Least cosine between a triangle's normal and its chart's mean: such a chart projects onto a plane without folding.
constexpr double kBend = 0.5;
constexpr size_t kFew = 4;
// Limits, as a share of the skin's area and of the covered texels.
constexpr double kMostLost = 0.02, kMostOverlap = 0.02;

dvec3 place(const FlowMesh& m, size_t corner) { return dvec3(m.rest[m.corner[corner]]); }
bool flat(const FlowMesh& m, size_t t) {
    double longest = 0;
    for (size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(place(m, 3 * t + k), place(m, 3 * t + (k + 1) % 3)));
    return glm::length(restNormal(m, t)) <= 1.0e-6 * longest * longest;
}

// A part of the skin and its flat layout, in metres.
struct Chart {
    std::vector<uint32_t> triangles;
    std::vector<uint32_t> places;  // of the mesh
    std::vector<uint32_t> corner;  // 3 a triangle: into places
    std::vector<dvec2> at;         // of each place
    dvec2 size{0.0};
};

class Cutter {
  public:
    explicit Cutter(const FlowMesh& mesh) : mesh_(mesh), chart_(mesh.triangleCount(), UINT32_MAX) {}

    // Grows charts from the largest triangle without one, adding first the triangles that bend least.
    std::vector<std::vector<uint32_t>> cut() {
        std::vector<dvec3> normal;
        for (size_t t = 0; t < chart_.size(); ++t) normal.push_back(restNormal(mesh_, t));
        std::vector<uint32_t> order;
        for (uint32_t t = 0; t < chart_.size(); ++t)
            if (!flat(mesh_, t)) order.push_back(t);
        std::stable_sort(order.begin(), order.end(),
                         [&](uint32_t a, uint32_t b) { return glm::dot(normal[a], normal[a]) > glm::dot(normal[b], normal[b]); });
        std::vector<std::vector<uint32_t>> charts;
        for (const uint32_t seed : order) {
            if (chart_[seed] != UINT32_MAX) continue;
            const auto own = static_cast<uint32_t>(charts.size());
            std::vector<uint32_t>& members = charts.emplace_back();
            dvec3 sum(0.0);
            struct Next {
                double off;
                uint32_t triangle;
                bool operator<(const Next& o) const { return off != o.off ? off > o.off : triangle > o.triangle; }
            };
            std::priority_queue<Next> queue;
            queue.push({0, seed});
            while (!queue.empty()) {
                const uint32_t t = queue.top().triangle;
                queue.pop();
                const dvec3 n = normal[t] / glm::length(normal[t]);
                if (chart_[t] != UINT32_MAX || (!members.empty() && glm::dot(n, sum) < kBend * glm::length(sum))) continue;
                chart_[t] = own;
                members.push_back(t);
                sum += normal[t];
                for (size_t edge = 0; edge < 3; ++edge) {
                    const uint32_t across = mesh_.across[3 * size_t{t} + edge];
                    if (across == FlowMesh::kOpen || chart_[across / 4] != UINT32_MAX || flat(mesh_, across / 4)) continue;
                    const dvec3& other = normal[across / 4];
                    queue.push({1 - glm::dot(other, sum) / (glm::length(other) * glm::length(sum)), across / 4});
                }
            }
        }
        return charts;
    }

  private:
    const FlowMesh& mesh_;
    std::vector<uint32_t> chart_;
};

Chart chartOf(const FlowMesh& m, std::vector<uint32_t> triangles) {
    Chart c;
    c.triangles = std::move(triangles);
    for (const uint32_t t : c.triangles) c.places.insert(c.places.end(), &m.corner[3 * size_t{t}], &m.corner[3 * size_t{t}] + 3);
    std::sort(c.places.begin(), c.places.end());
    c.places.erase(std::unique(c.places.begin(), c.places.end()), c.places.end());
    for (const uint32_t t : c.triangles)
        for (size_t k = 0; k < 3; ++k)
            c.corner.push_back(
                static_cast<uint32_t>(std::lower_bound(c.places.begin(), c.places.end(), m.corner[3 * size_t{t} + k]) - c.places.begin()));
    return c;
}

// Projects onto the plane perpendicular to the mean normal.
void project(const FlowMesh& m, Chart& c) {
    dvec3 n(0.0);
    for (const uint32_t t : c.triangles) n += restNormal(m, t);
    n = glm::length(n) > 0 ? glm::normalize(n) : dvec3(0, 0, 1);
    const dvec3 u = glm::normalize(glm::cross(std::abs(n.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0), n)), v = glm::cross(n, u);
    c.at.clear();
    for (const uint32_t p : c.places) c.at.emplace_back(glm::dot(dvec3(m.rest[p]), u), glm::dot(dvec3(m.rest[p]), v));
}

// Levy et al. 2002: in every triangle the map to UV is as near to a rotation and scale as possible; the two places farthest apart in the
// projection stay fixed. False if the equations cannot be solved.
bool layConformal(const FlowMesh& m, Chart& c) {
    project(m, c);
    const auto n = static_cast<int>(c.places.size());
    if (n <= 3) return true;
    const auto furthest = [&](const dvec2& from) {
        size_t best = 0;
        for (size_t k = 0; k < c.at.size(); ++k)
            if (glm::distance(c.at[k], from) > glm::distance(c.at[best], from)) best = k;
        return static_cast<int>(best);
    };
    const int first = furthest(c.at[0]), second = furthest(c.at[static_cast<size_t>(first)]);
    // Unknowns: u and v of all but the two, in the order of places.
    std::vector<int> unknown(static_cast<size_t>(n), -1);
    int count = 0;
    for (int k = 0; k < n; ++k)
        if (k != first && k != second) unknown[static_cast<size_t>(k)] = count++;
    std::vector<Eigen::Triplet<double>> entries;
    const auto rows = static_cast<int>(2 * c.triangles.size());
    Eigen::VectorXd right = Eigen::VectorXd::Zero(rows);
    for (int t = 0; t < rows / 2; ++t) {
        const uint32_t* corner = &c.corner[3 * static_cast<size_t>(t)];
        const dvec3 a(m.rest[c.places[corner[0]]]), e1 = dvec3(m.rest[c.places[corner[1]]]) - a,
                                                    e2 = dvec3(m.rest[c.places[corner[2]]]) - a;
        const dvec3 normal = glm::cross(e1, e2), x = glm::normalize(e1), y = glm::cross(glm::normalize(normal), x);
        const dvec2 p[3] = {dvec2(0.0), dvec2(glm::length(e1), 0), dvec2(glm::dot(e2, x), glm::dot(e2, y))};
        const double weight = 1 / std::sqrt(glm::length(normal));
        for (size_t k = 0; k < 3; ++k) {
            // (wr + i wi) times u + i v, summed over the corners, is 0.
            const dvec2 w = weight * (p[(k + 2) % 3] - p[(k + 1) % 3]);
            const auto at = static_cast<size_t>(corner[k]);
            const double terms[2][2] = {{w.x, -w.y}, {w.y, w.x}};  // of u and v, in the two rows
            for (int row = 0; row < 2; ++row)
                for (int axis = 0; axis < 2; ++axis) {
                    if (unknown[at] >= 0)
                        entries.emplace_back(2 * t + row, 2 * unknown[at] + axis, terms[row][axis]);
                    else
                        right[2 * t + row] -= terms[row][axis] * c.at[at][axis];
                }
        }
    }
    Eigen::SparseMatrix<double> matrix(rows, 2 * count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseMatrix<double> turned = matrix.transpose();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(turned * matrix);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::VectorXd solved = solver.solve(turned * right);
    if (solver.info() != Eigen::Success || !solved.allFinite()) return false;
    for (size_t k = 0; k < c.at.size(); ++k)
        if (unknown[k] >= 0) c.at[k] = dvec2(solved[2 * unknown[k]], solved[2 * unknown[k] + 1]);
    return true;
}

double areaInUv(const Chart& c, size_t t) {
    const dvec2 a = c.at[c.corner[3 * t]];
    return cross2(c.at[c.corner[3 * t + 1]] - a, c.at[c.corner[3 * t + 2]] - a);
}

// Scales the chart to its size on the skin, aligns it with its narrowest box and moves it to a corner. False if a triangle is mirrored or
// has shrunk to a hundredth.
bool settle(const FlowMesh& m, Chart& c) {
    double inUv = 0, onSkin = 0;
    for (size_t t = 0; t < c.triangles.size(); ++t) {
        inUv += areaInUv(c, t);
        onSkin += glm::length(restNormal(m, c.triangles[t]));
    }
    if (!(inUv > 0)) return false;
    const double scale = std::sqrt(onSkin / inUv);
    for (dvec2& p : c.at) p *= scale;
    for (size_t t = 0; t < c.triangles.size(); ++t)
        if (areaInUv(c, t) < 0.01 * glm::length(restNormal(m, c.triangles[t]))) return false;
    double least = 1.0e300;
    std::vector<dvec2> best;
    for (int k = 0; k < 30; ++k) {
        const double angle = 3.14159265358979 * k / 60, s = std::sin(angle), o = std::cos(angle);
        std::vector<dvec2> turned;
        dvec2 low(1.0e300), high(-1.0e300);
        for (const dvec2& p : c.at) {
            turned.emplace_back(o * p.x - s * p.y, s * p.x + o * p.y);
            low = glm::min(low, turned.back());
            high = glm::max(high, turned.back());
        }
        const dvec2 box = high - low;
        if (box.x * box.y >= least * (1 - 1.0e-9)) continue;
        least = box.x * box.y;
        c.size = box;
        for (dvec2& p : turned) p -= low;
        best.swap(turned);
    }
    c.at.swap(best);
    return true;
}

bool overlapsItself(const Chart& c) {
    const int edge = 512;
    const double scale = (edge - 2) / std::max({c.size.x, c.size.y, 1.0e-300});
    std::vector<uint8_t> taken(static_cast<size_t>(edge) * edge, 0);
    bool twice = false;
    for (size_t t = 0; t < c.triangles.size(); ++t) {
        UvTriangle f;
        for (size_t k = 0; k < 3; ++k) f.p[k] = c.at[c.corner[3 * t + k]] * scale;
        f.area = cross2(f.p[1] - f.p[0], f.p[2] - f.p[0]);
        eachCentre(f, -1.0e-6, [&](int x, int y) {
            uint8_t& there = taken[static_cast<size_t>(y) * edge + static_cast<size_t>(x)];
            twice = twice || there != 0;
            there = 1;
        });
    }
    return twice;
}

// Splits into two parts, each nearer to one of two triangles far apart.
void halve(const FlowMesh& m, const std::vector<uint32_t>& triangles, std::vector<std::vector<uint32_t>>& to) {
    std::vector<uint32_t> sorted = triangles;
    std::sort(sorted.begin(), sorted.end());
    const auto indexOf = [&](uint32_t t) {
        const auto found = std::lower_bound(sorted.begin(), sorted.end(), t);
        return found != sorted.end() && *found == t ? static_cast<size_t>(found - sorted.begin()) : sorted.size();
    };
    const auto spread = [&](std::vector<uint32_t> from) {
        std::vector<int> part(sorted.size(), -1);
        std::vector<uint32_t> order;
        for (size_t k = 0; k < from.size(); ++k) {
            part[indexOf(from[k])] = static_cast<int>(k);
            order.push_back(from[k]);
        }
        for (size_t k = 0; k < order.size(); ++k)
            for (size_t edge = 0; edge < 3; ++edge) {
                const uint32_t across = m.across[3 * size_t{order[k]} + edge];
                if (across == FlowMesh::kOpen) continue;
                const size_t at = indexOf(across / 4);
                if (at == sorted.size() || part[at] >= 0) continue;
                part[at] = part[indexOf(order[k])];
                order.push_back(across / 4);
            }
        return std::pair(part, order.back());
    };
    const uint32_t one = spread({sorted[0]}).second, other = spread({one}).second;
    const std::vector<int> part = spread({one, other}).first;
    std::vector<uint32_t> halves[2];
    for (size_t k = 0; k < sorted.size(); ++k) halves[part[k] == 1 ? 1 : 0].push_back(sorted[k]);
    to.push_back(std::move(halves[0]));
    to.push_back(std::move(halves[1]));
}

std::vector<Chart> layCharts(const FlowMesh& m) {
    std::vector<std::vector<uint32_t>> todo = Cutter(m).cut();
    std::vector<Chart> charts;
    for (size_t k = 0; k < todo.size(); ++k) {
        Chart c = chartOf(m, todo[k]);
        bool lies = layConformal(m, c) && settle(m, c) && !overlapsItself(c);
        // A ring or a spiral may overlap itself, but its parts do not. Small remaining charts are projected.
        if (!lies && c.triangles.size() <= kFew) {
            project(m, c);
            lies = settle(m, c) && (!overlapsItself(c) || c.triangles.size() == 1);
        }
        if (lies)
            charts.push_back(std::move(c));
        else if (c.triangles.size() > 1) {
            std::vector<std::vector<uint32_t>> halves;
            halve(m, c.triangles, halves);
            for (std::vector<uint32_t>& half : halves) todo.push_back(std::move(half));
        }
    }
    return charts;
}

// Packs the charts into the map at this number of texels per metre. False if they do not fit.
bool pack(const std::vector<Chart>& charts, double scale, int size, int gutter, std::vector<stbrp_rect>& rects) {
    rects.clear();
    for (const Chart& c : charts) {
        const double w = std::ceil(c.size.x * scale) + 2.0 * gutter, h = std::ceil(c.size.y * scale) + 2.0 * gutter;
        if (w > size || h > size) return false;
        rects.push_back({static_cast<int>(rects.size()), static_cast<stbrp_coord>(w), static_cast<stbrp_coord>(h), 0, 0, 0});
    }
    std::vector<stbrp_node> nodes(static_cast<size_t>(size));
    stbrp_context context;
    stbrp_init_target(&context, size, size, nodes.data(), size);
    return stbrp_pack_rects(&context, rects.data(), static_cast<int>(rects.size())) != 0;
}

}  // namespace

namespace {

// How a triangle lies on the map: the edge of its texels on the skin, m, and how much longer than wide they are.
struct TexelShape {
    double edge = 0, longer = 1;
};
TexelShape texelShape(const FlowMesh& m, size_t t, const UvTriangle& f) {
    const dvec3 e1 = place(m, 3 * t + 1) - place(m, 3 * t), e2 = place(m, 3 * t + 2) - place(m, 3 * t);
    const dvec2 f1 = f.p[1] - f.p[0], f2 = f.p[2] - f.p[0];
    // Of the map from texels to the skin: the product of its singular values, and half the sum of their squares over it.
    const double product = glm::length(glm::cross(e1, e2)) / std::abs(f.area);
    const dvec3 x = (e1 * f2.y - e2 * f1.y) / f.area, y = (e2 * f1.x - e1 * f2.x) / f.area;
    const double mean = product > 0 ? std::max(0.5 * (glm::dot(x, x) + glm::dot(y, y)) / product, 1.0) : 1.0;
    return {std::sqrt(product), mean + std::sqrt(mean * mean - 1)};
}

}  // namespace

bool UvReport::usable() const { return !missing && lost <= kMostLost && overlap <= kMostOverlap; }

std::string UvReport::sentence() const {
    if (missing) return "The skin has no UVs.";
    std::vector<std::string> said;
    const auto say = [&said](size_t n, const char* one, const char* many) {
        if (n > 0) said.push_back(fmt::format("{} {}", n, n == 1 ? one : many));
    };
    say(notNumbers, "triangle with UVs that are not finite", "triangles with UVs that are not finite");
    say(noArea, "triangle without area", "triangles without area");
    say(tooWide, "triangle wider than the map", "triangles wider than the map");
    if (overlap > 0.001) said.push_back(fmt::format("{:.1f} % of overlap", 100 * overlap));
    return said.empty() ? "" : fmt::format("The skin's UVs have {}.", fmt::join(said, ", "));
}

UvReport checkUvs(const FlowMesh& mesh, std::span<const vec2> uvs, int size) {
    UvReport r{.triangles = mesh.triangleCount()};
    r.missing = uvs.empty();
    if (r.missing) {
        r.lost = 1;
        return r;
    }
    ASSERT(uvs.size() == mesh.corner.size(), "give each corner of each triangle its own UV");
    std::vector<uint8_t> owned(static_cast<size_t>(size) * static_cast<size_t>(size), 0);
    size_t claims = 0, owns = 0;
    double area = 0, lost = 0, stretched = 0;
    std::vector<std::pair<double, double>> texels;  // edge, area of the triangle
    constexpr double kStretched = 4;
    for (size_t t = 0; t < mesh.triangleCount(); ++t) {
        const std::span<const vec2> uv = uvs.subspan(3 * t, 3);
        const UvTriangle f = uvTriangle(uv, size);
        const double own = glm::length(restNormal(mesh, t));
        area += own;
        if (!flat(mesh, t)) {
            r.notNumbers += f.fault == UvTriangle::Fault::notNumbers ? 1 : 0;
            r.noArea += f.fault == UvTriangle::Fault::noArea ? 1 : 0;
            r.tooWide += f.fault == UvTriangle::Fault::tooWide ? 1 : 0;
        }
        if (!f.good()) {
            lost += own;
            continue;
        }
        const TexelShape shape = texelShape(mesh, t, f);
        texels.emplace_back(shape.edge, own);
        stretched += shape.longer > kStretched ? own : 0;
        r.mirrored += f.area < 0 ? 1 : 0;
        r.beyond +=
            std::any_of(uv.begin(), uv.end(), [](const vec2& p) { return std::min(p.x, p.y) < 0 || std::max(p.x, p.y) > 1; }) ? 1 : 0;
        eachCentre(f, -1.0e-6, [&](int x, int y) {
            uint8_t& there = owned[static_cast<size_t>((y % size + size) % size) * static_cast<size_t>(size) +
                                   static_cast<size_t>((x % size + size) % size)];
            ++claims;
            owns += there == 0 ? 1 : 0;
            there = 1;
        });
    }
    r.lost = area > 0 ? lost / area : 1;
    r.stretched = area > 0 ? stretched / area : 0;
    std::sort(texels.begin(), texels.end());
    double below = 0;
    for (const auto& [edge, own] : texels) {
        if (below < 0.5 * (area - lost)) r.texel = edge;
        if (below < 0.95 * (area - lost)) r.widest = edge;
        below += own;
    }
    r.overlap = claims > 0 ? 1 - static_cast<double>(owns) / static_cast<double>(claims) : 0;
    return r;
}

Result<Unwrap> unwrap(const FlowMesh& mesh, int size, int gutter) {
    const std::vector<Chart> charts = layCharts(mesh);
    double area = 0;
    for (const Chart& c : charts) area += c.size.x * c.size.y;
    std::vector<stbrp_rect> rects, placed;
    double fits = 0, tooMuch = size / std::sqrt(area);
    if (pack(charts, 0, size, gutter, rects))
        for (int k = 0; k < 14; ++k) {
            const double middle = 0.5 * (fits + tooMuch);
            if (pack(charts, middle, size, gutter, rects)) {
                fits = middle;
                placed = rects;
            } else
                tooMuch = middle;
        }
    if (placed.empty())
        return badInput(
            fmt::format("a map of {0} x {0} texels has no room for the {1} charts of the skin; use a larger map", size, charts.size()));
    Unwrap out;
    out.uvs.assign(mesh.corner.size(), vec2(0.5F));
    out.chart.assign(mesh.triangleCount(), 0);
    out.charts = static_cast<uint32_t>(charts.size());
    out.texelsPerMetre = fits;
    double whole = 0;
    for (const stbrp_rect& r : placed) {
        const Chart& c = charts[static_cast<size_t>(r.id)];
        const dvec2 corner(r.x + gutter, r.y + gutter);
        for (size_t t = 0; t < c.triangles.size(); ++t) {
            out.chart[c.triangles[t]] = static_cast<uint32_t>(r.id);
            for (size_t k = 0; k < 3; ++k)
                out.uvs[3 * size_t{c.triangles[t]} + k] = vec2((corner + c.at[c.corner[3 * t + k]] * fits) / double(size));
            // The sum of the squares of the singular values, over twice their product: from edges on the skin and in UV.
            const size_t first = 3 * size_t{c.triangles[t]};
            const dvec3 e1 = place(mesh, first + 1) - place(mesh, first), e2 = place(mesh, first + 2) - place(mesh, first);
            const dvec2 f1 = c.at[c.corner[3 * t + 1]] - c.at[c.corner[3 * t]], f2 = c.at[c.corner[3 * t + 2]] - c.at[c.corner[3 * t]];
            const double twice = glm::length(glm::cross(e1, e2));
            const double energy =
                (glm::dot(e2, e2) * glm::dot(f1, f1) - 2 * glm::dot(e1, e2) * glm::dot(f1, f2) + glm::dot(e1, e1) * glm::dot(f2, f2)) /
                (2 * twice);
            out.distortion += energy / cross2(f1, f2) * twice;
            whole += twice;
        }
    }
    out.distortion /= whole;
    return out;
}

Result<SkinUvs> skinUvs(const FlowMesh& mesh, const MeshView& from, int size) {
    SkinUvs s;
    s.uvs = cornerUvs(mesh, from);
    s.given = checkUvs(mesh, s.uvs, size);
    s.notice = s.given.sentence();
    if (s.given.usable()) return s;
    Result<Unwrap> own = unwrap(mesh, size);
    if (!own) return own.error();
    s.uvs = std::move(own->uvs);
    s.unwrapped = true;
    s.charts = own->charts;
    s.notice += fmt::format(" New UVs were made, with {} chart{}.", own->charts, own->charts == 1 ? "" : "s");
    return s;
}

}  // namespace rivulet
