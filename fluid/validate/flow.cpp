// Flow on skins: films, held and sliding drops, the same path for every layout of the mesh, and a ledger that closes.
#include <fmt/format.h>

#include <cmath>
#include <glm/packing.hpp>
#include <random>

#include "fluid/flow/flow_maps.h"
#include "fluid/session/reference_data.h"
#include "fluid/validate/flow_case.h"

namespace rivulet {

namespace {

Result<SurfaceFlow> flowOn(const Under& u, const Shape& shape, const SurfaceFlowParams& params) {
    Result<FlowMesh> mesh = makeFlowMesh(shape.view());
    if (!mesh) return mesh.error();
    return SurfaceFlow::create(*u.settings.device, std::move(*mesh), params);
}

// A film of jittered particles on a vertical wall: speed rho g h^2 / (3 mu).
Status film(Under& u) {
    for (const Layout layout : kLayouts) {
        SurfaceFlowParams p;
        p.viscosity = 1.0e-3F;
        p.density = 1000;
        p.advancing = p.receding = 1;  // a wetting liquid: otherwise so thin a film breaks up
        p.trail = 0;
        p.capacity = 1 << 14;
        const Shape wall = laidOut(sheetShape(vec3(0, 0.2F, 0), vec3(0, -0.2F, 0), vec3(0.08F, 0, 0), 40, 16), layout);
        Result<SurfaceFlow> flow = flowOn(u, wall, p);
        if (!flow) return flow.error();
        const double spacing = u.settings.quick ? 1.5e-3 : 1.2e-3, height = 1.0e-4;
        std::mt19937 random(5);
        std::uniform_real_distribution<double> off(-0.3 * spacing, 0.3 * spacing);
        for (double y = 0.08; y < 0.18; y += spacing)
            for (double x = 0.01; x < 0.07; x += spacing)
                flow->add(nearestPoint(flow->mesh(), vec3(dvec3(x + off(random), y + off(random), 0))),
                          static_cast<uint32_t>(spacing * spacing * height * 1.0e15), vec3(0.0F), true);
        double sum = 0, count = 0;
        for (int k = 0; k < 18; ++k) {
            if (!u.step(*flow, {})) return ok();
            if (k < 3) continue;
            for (const SkinDrop& d : flow->drops())
                if (std::abs(d.position.x - 0.04F) < 0.02F && std::abs(d.position.y - 0.13F) < 0.03F) {
                    sum -= double{d.velocity.y};
                    count += 1;
                }
        }
        const double speed = 1000 * kGravity * height * height / (3 * 1.0e-3), measured = sum / std::max(count, 1.0);
        u.found(fmt::format("Nusselt film of 100 um, mesh {}", layoutName(layout)), "m/s", measured, speed, std::abs(measured / speed - 1),
                0.05);
    }
    return ok();
}

// A drop on a vertical wall that grows by fifty merges until it slides.
Status heldDrop(Under& u, double advancing, double receding, uint32_t quads, Layout layout) {
    SurfaceFlowParams p;
    p.advancing = static_cast<float>(advancing);
    p.receding = static_cast<float>(receding);
    const Shape wall = laidOut(sheetShape(vec3(0, 0.1F, 0), vec3(0, -0.1F, 0), vec3(0.1F, 0, 0), quads, quads), layout);
    Result<SurfaceFlow> flow = flowOn(u, wall, p);
    if (!flow) return flow.error();
    const double expected = furmidgeVolume(p);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> offset(-2.0e-4F, 2.0e-4F);
    double grown = 0, first = 0;
    const auto birth = static_cast<uint32_t>(expected * 1.0e15 / 50);
    for (int k = 0; k < 70 && first == 0; ++k) {
        flow->add(nearestPoint(flow->mesh(), vec3(0.05F + offset(random), 0.05F + offset(random), 0)), birth);
        for (int step = 0; step < 6; ++step)
            if (!u.step(*flow, {})) return ok();
        grown += birth * 1.0e-15;
        for (const SkinDrop& d : flow->drops())
            if (glm::length(d.velocity) > 1.0e-3F) first = grown;
    }
    u.found(fmt::format("held drop, {:.0f}/{:.0f} deg, {} quads a side, mesh {}", advancing, receding, quads, layoutName(layout)), "ul",
            first * 1.0e9, expected * 1.0e9, std::abs(first / expected - 1), 0.05);
    return ok();
}

// The speed of a drop of 6 microlitres down a slope with Bo = V^(2/3) rho g sin(a) / gamma. Empty: stopped.
Result<double> slidingSpeed(Under& u, const SurfaceFlowParams& p, double bond) {
    const double volume = 6.0e-9, sine = bond * double{p.surfaceTension} / (std::pow(volume, 2.0 / 3) * double{p.density} * kGravity);
    const double a = std::asin(std::min(sine, 1.0));
    const Shape slope = sheetShape(vec3(0.0F), vec3(0.0F, 0.0F, -0.03F), vec3(dvec3(0.3 * std::cos(a), -0.3 * std::sin(a), 0)), 6, 60);
    Result<SurfaceFlow> flow = flowOn(u, slope, p);
    if (!flow) return flow.error();
    const auto at = static_cast<float>(0.02 * std::cos(a)), down = static_cast<float>(-0.02 * std::sin(a));
    flow->add(nearestPoint(flow->mesh(), vec3(at, down, -0.0151F)), static_cast<uint32_t>(volume * 1.0e15));
    double speed = 0;
    for (int k = 0; k < 60; ++k) {
        if (!u.step(*flow, {})) return 0;
        for (const SkinDrop& d : flow->drops()) speed = glm::length(d.velocity);
    }
    return speed;
}

// Le Grand, Daerr and Limat 2005, three oils on one surface: one law for all with the surface's two coefficients (its hold k and its
// friction, see dragOf()), and each oil with its own calibration.
Status slidingDrops(Under& u) {
    struct Oil {
        double eta, advancing, receding, slope, critical;
    };
    std::vector<Oil> oils;
    const auto column = [](size_t k) { return referenceCurve("le_grand_2005_sliding", 0, k); };
    for (size_t k = 0; k < column(1).size(); ++k)
        oils.push_back({1.0e-3 * column(1)[k].x, column(1)[k].y, column(2)[k].y, column(3)[k].y, column(4)[k].y});
    const double rad = kPiD / 180;
    for (const bool own : {false, true})
        for (const Oil& oil : oils) {
            SurfaceFlowParams p;
            p.surfaceTension = 0.0209F;  // silicone oil
            p.density = 964;
            p.viscosity = static_cast<float>(oil.eta);
            p.advancing = static_cast<float>(oil.advancing);
            p.receding = static_cast<float>(oil.receding);
            p.trail = p.airDrag = 0;
            p.pearls = false;
            if (own) {
                // Ca = (Bo - 2 c k (cos r - cos a)) / (2 c beta), c the radius of the contact area over V^(1/3).
                const double h = std::tan(0.25 * (oil.advancing + oil.receding) * rad), c = std::cbrt(6 / (kPiD * h * (3 + h * h)));
                p.drag = static_cast<float>(1 / (2 * c * oil.slope));
                p.hold = static_cast<float>(oil.critical / (2 * c * (std::cos(oil.receding * rad) - std::cos(oil.advancing * rad))));
            } else {
                p.hold = 0.8F;
                p.wallFriction = 4.0e6F;
            }
            double worst = 0, at = 0, there = 0;
            for (const double bond : {0.6, 1.0, 1.4}) {
                const Result<double> speed = slidingSpeed(u, p, bond);
                if (!speed) return speed.error();
                if (u.stopped) return ok();
                const double expected = oil.slope * (bond - oil.critical) * double{p.surfaceTension} / oil.eta;
                if (std::abs(*speed / expected - 1) >= worst) {
                    worst = std::abs(*speed / expected - 1);
                    at = *speed;
                    there = expected;
                }
            }
            u.found(fmt::format("sliding drop of {:.0f} cP, {}", 1.0e3 * oil.eta, own ? "law of its own" : "one law for three oils"), "m/s",
                    at, there, worst, own ? 0.05 : 0.2);
        }
    return ok();
}

// A drop of a microlitre or more on a vertical sheet of 16 mm, and what its map shows of it.
struct Outline {
    double length = 0, width = 0, high = 0;  // m
    double back = 0;                         // m, its length behind the widest line
    double narrows = 0;  // its width near its end grows with this power of the distance: 0.5 round, 1 a corner, more a cusp
    size_t drops = 0;
};

Result<Outline> outlineOf(Under& u, const SurfaceFlowParams& params, double microlitres, double gravity, int steps) {
    constexpr int kSize = 1024;
    constexpr double kEdge = 0.016, kTexel = kEdge / kSize;
    const auto edge = static_cast<float>(kEdge);
    const Shape sheet = sheetShape(vec3(0.0F), vec3(edge, 0, 0), vec3(0, -edge, 0), 8, 8);
    Result<SurfaceFlow> flow = flowOn(u, sheet, params);
    if (!flow) return flow.error();
    Result<FlowMaps> maps = FlowMaps::create(*flow, cornerUvs(flow->mesh(), sheet.view()), kSize);
    if (!maps) return maps.error();
    flow->add(nearestPoint(flow->mesh(), vec3(0.5F * edge, -0.4F * edge, 0)), static_cast<uint32_t>(microlitres * 1.0e6));
    for (int k = 0; k < steps; ++k)
        if (!u.step(*flow, {.gravity = vec3(0, -static_cast<float>(gravity), 0)})) return Outline{};
    maps->draw(*flow);
    const auto words = u.settings.device->readAll<uint32_t>(maps->texels(), size_t{2} * kSize * kSize);
    std::vector<double> half(kSize, 0.0);  // m, half the foot's width in each row, downhill
    Outline o;
    o.drops = flow->drops().size();
    const double middle = double{flow->drops()[0].position.x};
    for (size_t y = 0; y < kSize; ++y)
        for (size_t x = 0; x < kSize; ++x) {
            const double high = 1.0e-3 * double{glm::unpackHalf2x16(words[2 * (y * kSize + x) + 1]).x};
            if (high <= 0 || std::abs((static_cast<double>(x) + 0.5) * kTexel - middle) > 0.006) continue;
            half[y] += 0.5 * kTexel;
            o.high = std::max(o.high, high);
        }
    // From its front back to the first gap: pearls lie behind it.
    size_t front = kSize - 1;
    while (front > 0 && half[front] == 0) --front;
    size_t end = front;
    while (end > 0 && half[end - 1] > 0) --end;
    o.length = static_cast<double>(front - end + 1) * kTexel;
    o.width = 2 * *std::max_element(half.begin() + static_cast<ptrdiff_t>(end), half.begin() + static_cast<ptrdiff_t>(front) + 1);
    o.back = o.length - 0.5 * o.width;
    const auto at = [&](double share) { return half[end + static_cast<size_t>(share * o.back / kTexel)]; };
    o.narrows = std::log(at(0.2) / at(0.05)) / std::log(4.0);
    return o;
}

// The shapes that are drawn: a drop that is about to slide, and the running drops of Podgorski, Flesselles and Limat 2001.
Status dropShapes(Under& u) {
    const double degree = 180 / kPiD;
    for (const auto& [advancing, receding] : {std::pair(60.0, 40.0), std::pair(90.0, 60.0)}) {
        SurfaceFlowParams p;
        p.advancing = static_cast<float>(advancing);
        p.receding = static_cast<float>(receding);
        const Result<Outline> o = outlineOf(u, p, 0.99e9 * furmidgeVolume(p), kGravity, 3);
        if (!o) return o.error();
        if (u.stopped) return ok();
        // Of a cap: height over radius is tan(angle / 2).
        const double front = 2 * degree * std::atan(2 * o->high / o->width), back = 2 * degree * std::atan(o->high / o->back);
        const std::string what = fmt::format("drop about to slide, {:.0f}/{:.0f} deg, as drawn", advancing, receding);
        u.found(what + ": angle in front", "deg", front, advancing, std::abs(front / advancing - 1), 0.1);
        u.found(what + ": angle behind", "deg", back, receding, std::abs(back / receding - 1), 0.1);
    }
    SurfaceFlowParams oil;
    oil.surfaceTension = 0.0209F;
    oil.density = 964;
    oil.viscosity = 0.104F;
    oil.advancing = 52.9F;
    oil.receding = 42.7F;
    oil.hold = 0;  // gravity is set for the speed
    oil.trail = oil.airDrag = 0;
    double longest = 0, least = 1;
    bool cornered = false;
    for (const dvec2& row : referenceCurve("le_grand_2005_shapes")) {
        const double h = std::tan(0.25 * double{oil.advancing + oil.receding} / degree), volume = 6.0e-9;
        const double width = 2 * std::cbrt(6 * volume / (kPiD * h * (3 + h * h)));
        const double gravity = row.x * double{oil.surfaceTension} * dragOf(oil) * width / (double{oil.density} * volume);
        const Result<Outline> o = outlineOf(u, oil, 1.0e9 * volume, gravity, 180);
        if (!o) return o.error();
        if (u.stopped) return ok();
        const double shape = o->drops > 1 ? 3 : o->narrows > 1.0 ? 2 : o->narrows > 0.75 ? 1 : 0;
        u.found(fmt::format("drop at Ca {:.5f}, as drawn: 0 oval, 1 corner, 2 cusp, 3 pearling", row.x), "", shape, row.y,
                std::abs(shape - row.y), 0.5);
        if (row.y == 1 && !cornered) {
            cornered = true;  // Le Grand, Daerr and Limat 2005: 23 degrees where corners begin
            const double back = 2 * degree * std::atan(o->high / o->back);
            u.found("drop with a corner, as drawn: angle behind", "deg", back, 23, std::abs(back / 23 - 1), 0.15);
        }
        const double ratio = o->length / o->width;
        least = std::min(least, ratio - longest);
        longest = std::max(longest, ratio);
    }
    u.found("running drops, as drawn: longer with speed, least gain of length over width", "", least, 0, std::max(-least, 0.0), 0.0);
    return ok();
}

struct Way {
    std::vector<vec3> places;
    double arrival = 0;  // s, at which it had covered the length of the first path
};

// A tear runs down a shape of 5 cm from `from` until it is below `level`.
Result<Way> wayDown(Under& u, const Shape& shape, const vec3& from, float level) {
    SurfaceFlowParams p;
    p.trail = 5.0e-6F;
    Result<SurfaceFlow> flow = flowOn(u, shape, p);
    if (!flow) return flow.error();
    flow->add(nearestPoint(flow->mesh(), from), 12000000);
    Way way;
    for (int k = 0; k < 600; ++k) {
        if (!u.step(*flow, {})) return way;
        const std::vector<SkinDrop> drops = flow->drops();
        if (drops.empty()) break;
        way.places.push_back(drops[0].position);
        way.arrival = k * kStep;
        if (drops[0].position.y < level) {
            // Interpolated between two steps.
            const float before = way.places[way.places.size() - 2].y, now = drops[0].position.y;
            way.arrival -= kStep * double{(level - now) / std::max(before - now, 1.0e-9F)};
            break;
        }
    }
    return way;
}

Status samePath(Under& u) {
    for (const PathCase& kind : pathCases()) {
        Way own;
        double apart = 0, late = 0, length = 0;
        for (const Layout layout : kLayouts) {
            Result<Way> way = wayDown(u, laidOut(kind.shape, layout), kind.from, kind.level);
            if (!way) return way.error();
            if (u.stopped) return ok();
            if (layout == Layout::own) {
                own = *way;
                for (size_t k = 1; k < own.places.size(); ++k) length += double{glm::distance(own.places[k], own.places[k - 1])};
                continue;
            }
            late = std::max(late, std::abs(way->arrival / own.arrival - 1));
            for (size_t k = 0; k < std::min(own.places.size(), way->places.size()); ++k)
                apart = std::max(apart, double{glm::distance(own.places[k], way->places[k])} / length);
        }
        u.found(fmt::format("{}: paths of four layouts, apart over their length", kind.name), "", apart, 0, apart, 0.02);
        u.found(fmt::format("{}: arrival, latest against the own layout's", kind.name), "", late, 0, late, 0.02);
    }
    return ok();
}

// A minute of tears on a ball that expands and contracts, with gusts: all emitted volume is accounted for, to a picolitre.
Status ledger(Under& u) {
    const Shape rest = ballShape(0.06F, 64);
    SurfaceFlowParams p;
    p.capacity = 512;
    p.evaporation = 1.0e-7F;
    Result<SurfaceFlow> flow = flowOn(u, rest, p);
    if (!flow) return flow.error();
    breathe(u, *flow, rest, 50000, 1.0e-5);  // 30 microlitres per minute and eye
    return ok();
}

}  // namespace

Result<Outcome> runFlow(const CaseSettings& settings) {
    if (settings.method == "flow_thesis") return runFlowThesis(settings);
    Under u{.settings = settings};
    u.outcome.method = "flow";
    const FlowPart parts[] = {
        {0.15, [&] { return film(u); }},
        {0.30,
         [&] {
             for (const auto& [advancing, receding] : {std::pair(60.0, 40.0), std::pair(90.0, 60.0)})
                 for (const uint32_t quads : {4U, 60U})
                     for (const Layout layout : {Layout::own, Layout::turned, Layout::pieces}) {
                         if (settings.quick && layout != Layout::own) continue;
                         if (Status held = heldDrop(u, advancing, receding, quads, layout); !held || u.stopped) return held;
                     }
             return ok();
         }},
        {0.45, [&] { return slidingDrops(u); }},
        {0.5, [&] { return dropShapes(u); }},
        {0.65, [&] { return samePath(u); }},
        {1.0, [&] { return ledger(u); }},
    };
    return runParts(u, parts);
}

}  // namespace rivulet
