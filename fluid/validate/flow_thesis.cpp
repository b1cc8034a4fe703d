// Thesis mode of flow on skins, measured as the default mode: dependence on the layout, missing terminal speed, and the ledger. Only
// reported, not judged.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/flow/flow_maps.h"
#include "fluid/validate/flow_case.h"
#include "fluid/validate/thesis_forms.h"

namespace rivulet {

namespace {

Result<SurfaceFlow> thesisOn(const Under& u, const Shape& shape, const ThesisParams& params = {}, const SurfaceFlowParams& liquid = {}) {
    Result<FlowMesh> mesh = makeFlowMesh(shape.view());
    if (!mesh) return mesh.error();
    const std::vector<vec2> uvs = cornerUvs(*mesh, shape.view());
    return SurfaceFlow::createThesis(*u.settings.device, std::move(*mesh), uvs, liquid, params);
}

// The angle by which (12)-(18) turn the force along the skin, over all triangles.
Status turnedForce(Under& u, const PathCase& kind, Layout layout) {
    const Shape shape = laidOut(kind.shape, layout);
    Result<FlowMesh> made = makeFlowMesh(shape.view());
    if (!made) return made.error();
    const FlowMesh& mesh = *made;
    const std::vector<vec2> uvs = cornerUvs(mesh, shape.view());
    const auto cornerOf = [&](size_t k) { return dvec3(mesh.rest[mesh.corner[k]]); };
    std::vector<dvec3> normal(mesh.rest.size(), dvec3(0.0));
    for (size_t k = 0; k < mesh.corner.size(); ++k) {
        const size_t t = k - k % 3;
        normal[mesh.corner[k]] += glm::cross(cornerOf(t + 1) - cornerOf(t), cornerOf(t + 2) - cornerOf(t));
    }
    std::vector<double> printed, mended;
    const dvec3 force(0, -kGravity, 0);
    for (size_t t = 0; t < mesh.corner.size(); t += 3) {
        const dvec2 a(uvs[t]), ab = dvec2(uvs[t + 1]) - a, ac = dvec2(uvs[t + 2]) - a;
        if (std::abs(ab.x * ac.y - ab.y * ac.x) < 1.0e-12) continue;
        const dmat3 m0 = thesisFrame({cornerOf(t), cornerOf(t + 1), cornerOf(t + 2)}, {a, dvec2(uvs[t + 1]), dvec2(uvs[t + 2])});
        dvec3 n(0.0);
        for (size_t k = t; k < t + 3; ++k) n += glm::normalize(normal[mesh.corner[k]]);
        printed.push_back(turnedBy(m0, printedFrame(m0, n), force) * 180 / kPiD);
        mended.push_back(turnedBy(m0, correctedFrame(m0, n), force) * 180 / kPiD);
    }
    for (auto& [name, all] : {std::pair("printed", &printed), std::pair("mended", &mended)}) {
        std::sort(all->begin(), all->end());
        const double median = (*all)[all->size() / 2], most = (*all)[all->size() * 95 / 100];
        u.found(fmt::format("force turned, {}, mesh {}, median (95 % below {:.1f})", name, layoutName(layout), most), "deg", median, 0,
                median / 180, {});
    }
    return ok();
}

// The largest single drop that stays on a vertical wall.
Status thesisHeldDrop(Under& u, Layout layout) {
    constexpr int kRow = 7;
    Shape wall = laidOut(sheetShape(vec3(0, 0.1F, 0), vec3(0, -0.1F, 0), vec3(0.1F, 0, 0), 60, 60), layout);
    Result<SurfaceFlow> flow = thesisOn(u, wall);
    if (!flow) return flow.error();
    for (int k = 0; k < kRow * kRow; ++k) {
        const int row = k / kRow;
        const vec3 at(0.011F + 0.013F * static_cast<float>(k % kRow), 0.011F + 0.013F * static_cast<float>(row), 0);
        flow->add(nearestPoint(flow->mesh(), at), static_cast<uint32_t>(2.0e3 * std::pow(1.21, k)));
    }
    for (int k = 0; k < 3; ++k)
        if (!u.step(*flow, {}, 1.0e-3)) return ok();
    double held = 0;
    for (const SkinDrop& d : flow->drops())
        if (glm::length(d.velocity) == 0) held = std::max(held, d.volume);
    const double tears = furmidgeVolume({});
    u.found(fmt::format("largest drop held, mesh {}", layoutName(layout)), "ul", held * 1.0e9, tears * 1.0e9, std::abs(held / tears - 1),
            {});
    return ok();
}

Status terminalSpeed(Under& u) {
    const Shape wall = sheetShape(vec3(0, 20, 0), vec3(0, -20, 0), vec3(2, 0, 0), 20, 2);
    Result<SurfaceFlow> flow = thesisOn(u, wall);
    if (!flow) return flow.error();
    flow->add(nearestPoint(flow->mesh(), vec3(0.9F, 19.5F, 0)), 12000000);
    double half = 0, speed = 0;
    for (int k = 1; k <= 60; ++k) {
        if (!u.step(*flow, {})) return ok();
        for (const SkinDrop& d : flow->drops()) speed = glm::length(d.velocity);
        if (k == 30) half = speed;
    }
    u.found("speed after 1 s over that after 0.5 s; terminal: 1", "", speed / half, 1, std::abs(speed / half - 1), {});
    return ok();
}

struct ThesisPath {
    std::vector<vec3> places;
    double arrival = -1;  // s; -1: the drop drained or stays
};

Result<ThesisPath> thesisPathDown(Under& u, const PathCase& kind, Layout layout) {
    Result<SurfaceFlow> flow = thesisOn(u, laidOut(kind.shape, layout));
    if (!flow) return flow.error();
    flow->add(nearestPoint(flow->mesh(), kind.from), 12000000);
    ThesisPath way;
    constexpr double kFine = kStep / 8;
    for (int k = 0; k < 1200; ++k) {
        if (!u.step(*flow, {}, kFine)) return way;
        const std::vector<SkinDrop> drops = flow->drops();
        if (drops.empty()) break;
        way.places.push_back(drops[0].position);
        if (drops[0].position.y >= kind.level) continue;
        way.arrival = k * kFine;
        break;
    }
    return way;
}

// Distance by position, because arrival times differ: from each point of one path to the nearest point of the other.
Status thesisSamePath(Under& u, const PathCase& kind) {
    ThesisPath own;
    double apart = 0, late = 0, length = 0, arrived = 0;
    for (const Layout layout : kLayouts) {
        Result<ThesisPath> way = thesisPathDown(u, kind, layout);
        if (!way) return way.error();
        if (u.stopped) return ok();
        arrived += way->arrival >= 0 ? 1 : 0;
        if (layout == Layout::own) {
            own = *way;
            for (size_t k = 1; k < own.places.size(); ++k) length += double{glm::distance(own.places[k], own.places[k - 1])};
            continue;
        }
        if (way->arrival >= 0 && own.arrival >= 0) late = std::max(late, std::abs(way->arrival / own.arrival - 1));
        for (const vec3& x : way->places) {
            double nearest = 1;
            for (const vec3& y : own.places) nearest = std::min(nearest, double{glm::distance(x, y)});
            apart = std::max(apart, nearest / length);
        }
    }
    u.found(fmt::format("{}: paths of four layouts, apart over their length", kind.name), "", apart, 0, apart, {});
    u.found(fmt::format("{}: layouts of four in which it arrives", kind.name), "", arrived, 4, 1 - arrived / 4, {});
    if (own.arrival >= 0)
        u.found(fmt::format("{}: their arrival against the own layout's, furthest off", kind.name), "", late, 0, late, {});
    return ok();
}

Status thesisLedger(Under& u) {
    const Shape rest = ballShape(0.06F, 64);
    Result<SurfaceFlow> flow = thesisOn(u, rest, {}, {.capacity = 512});
    if (!flow) return flow.error();
    breathe(u, *flow, rest, 500000, {});
    return ok();
}

}  // namespace

Result<Outcome> runFlowThesis(const CaseSettings& settings) {
    Under u{.settings = settings};
    u.outcome.method = "flow_thesis";
    const std::vector<PathCase> kinds = pathCases();
    const FlowPart parts[] = {
        {0.2,
         [&] {
             for (const Layout layout : kLayouts)
                 if (Status turned = turnedForce(u, kinds[0], layout); !turned) return turned;
             return ok();
         }},
        {0.3,
         [&] {
             for (const Layout layout : kLayouts)
                 if (Status held = thesisHeldDrop(u, layout); !held || u.stopped) return held;
             return ok();
         }},
        {0.4, [&] { return terminalSpeed(u); }},
        {0.6,
         [&] {
             for (const PathCase& kind : kinds)
                 if (Status same = thesisSamePath(u, kind); !same || u.stopped) return same;
             return ok();
         }},
        {1.0, [&] { return thesisLedger(u); }},
    };
    return runParts(u, parts);
}

}  // namespace rivulet
