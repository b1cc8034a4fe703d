#include "fluid/sim/solids/body_contacts.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>

#include "engine/core/assert.h"
#include "shaders/fluid/solids/body_state.h"

namespace rivulet {

namespace {

// The lowest colour that neither has yet. `used`: of each body.
uint32_t freeColour(std::vector<std::vector<bool>>& used, std::span<const uint32_t> bodies) {
    for (uint32_t colour = 0;; ++colour) {
        const bool free = std::ranges::all_of(bodies, [&](uint32_t body) { return colour >= used[body].size() || !used[body][colour]; });
        if (!free) continue;
        for (const uint32_t body : bodies) {
            used[body].resize(std::max<size_t>(used[body].size(), size_t{colour} + 1));
            used[body][colour] = true;
        }
        return colour;
    }
}

ContactRow rowOf(const BodyContact& c) {
    return {vec4(c.onA, c.radiusA),
            vec4(c.onB, c.radiusB),
            vec4(c.normal, c.friction),
            vec4(c.velocityB, c.restitution),
            vec4(c.centreB, c.secondsB),
            vec4(c.spinB, 0.0F),
            NO_CONTACT,
            NO_CONTACT,
            NO_CONTACT,
            NO_CONTACT};
}

// m, between where a contact was and is; infinite if it is another.
float wayBetween(const ContactRow& was, const ContactRow& is) {
    if (glm::dot(vec3(is.normal), vec3(was.normal)) < 0.9F) return std::numeric_limits<float>::infinity();
    // A ball's contacts turn with it: only those of its partner tell them apart.
    const bool ball = is.onA.w > 0;
    return glm::length(vec3(ball ? is.onB : is.onA) - vec3(ball ? was.onB : was.onA));
}

// Each contact of a pair continues the nearest of the frame before within `near` (m). The impulses of those that nothing continues go to
// the nearest one: together they carry what they carried.
void continueFrom(const ContactRows& before, const ContactPair& was, const ContactPair& pair, float near, ContactRows& rows) {
    std::vector<bool> taken(was.end - was.first);
    for (uint32_t k = pair.first; k < pair.end; ++k) {
        float least = near;
        for (uint32_t old = was.first; old < was.end; ++old) {
            const float apart = wayBetween(before.contacts[old], rows.contacts[k]);
            if (taken[old - was.first] || !(apart < least)) continue;
            least = apart;
            rows.contacts[k].before = old;
        }
        if (rows.contacts[k].before != NO_CONTACT) taken[rows.contacts[k].before - was.first] = true;
    }
    for (uint32_t old = was.first; old < was.end; ++old) {
        if (taken[old - was.first]) continue;
        uint32_t* place = nullptr;
        float least = std::numeric_limits<float>::infinity();
        for (uint32_t k = pair.first; k < pair.end; ++k) {
            ContactRow& row = rows.contacts[k];
            uint32_t* free = nullptr;
            for (uint32_t* one : {&row.before, &row.before1, &row.before2, &row.before3})
                if (free == nullptr && *one == NO_CONTACT) free = one;
            const float apart = wayBetween(before.contacts[old], row);
            if (free == nullptr || !(apart < least)) continue;
            least = apart;
            place = free;
        }
        if (place != nullptr) *place = old;
    }
}

// Whether `separations` are a linear function of the places, within `flat`.
bool isAffine(std::span<const dvec2> places, std::span<const float> separations, float flat) {
    const auto count = static_cast<double>(places.size());
    dvec2 middle(0.0);
    double mean = 0;
    for (size_t k = 0; k < places.size(); ++k) {
        middle += places[k] / count;
        mean += double{separations[k]} / count;
    }
    double xx = 0, xy = 0, yy = 0;
    dvec2 slope(0.0);
    for (size_t k = 0; k < places.size(); ++k) {
        const dvec2 p = places[k] - middle;
        xx += p.x * p.x;
        xy += p.x * p.y;
        yy += p.y * p.y;
        slope += (double{separations[k]} - mean) * p;
    }
    const double trace = xx + yy;
    if (!(trace > 0)) return true;
    // Points on a line have no slope across it.
    const double little = 1.0e-9 * trace;
    xx += little;
    yy += little;
    const double det = xx * yy - xy * xy;
    slope = dvec2(yy * slope.x - xy * slope.y, xx * slope.y - xy * slope.x) / det;
    for (size_t k = 0; k < places.size(); ++k)
        if (!(std::abs(double{separations[k]} - mean - glm::dot(slope, places[k] - middle)) <= double{flat})) return false;
    return true;
}

}  // namespace

ContactRows contactRows(std::span<const BodyContact> contacts, const std::vector<bool>& moves, const ContactRows& before, float near) {
    ContactRows rows;
    rows.slots.assign(moves.size(), NO_SLOT);
    std::vector<uint32_t> order(contacts.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](uint32_t k) { return std::tuple(contacts[k].a, contacts[k].b); });
    struct Pair {
        size_t first, end;  // in order
        uint32_t colour;
    };
    std::vector<Pair> pairs;
    std::vector<std::vector<bool>> used(moves.size());
    uint32_t colours = 0;
    for (size_t k = 0; k < order.size();) {
        const BodyContact& c = contacts[order[k]];
        ASSERT(c.a < moves.size() && (c.b < moves.size() || c.b == BodyContact::kSolid) && c.a != c.b,
               "a contact of two bodies, or of one");
        size_t end = k + 1;
        while (end < order.size() && contacts[order[end]].a == c.a && contacts[order[end]].b == c.b) ++end;
        std::vector<uint32_t> bodies;
        for (const uint32_t body : {c.a, c.b})
            if (body != BodyContact::kSolid && moves[body]) bodies.push_back(body);
        const uint32_t colour = freeColour(used, bodies);
        colours = std::max(colours, colour + 1);
        pairs.push_back({k, end, colour});
        for (const uint32_t body : {c.a, c.b})
            if (body != BodyContact::kSolid && rows.slots[body] == NO_SLOT) rows.slots[body] = rows.touching++;
        k = end;
    }
    std::ranges::stable_sort(pairs, {}, &Pair::colour);
    rows.pairs.reserve(pairs.size());
    rows.contacts.reserve(contacts.size());
    rows.colours.assign(colours > 0 ? colours + 1 : 0, 0);
    for (const Pair& pair : pairs) {
        const BodyContact& c = contacts[order[pair.first]];
        const bool solid = c.b == BodyContact::kSolid;
        const auto first = static_cast<uint32_t>(rows.contacts.size());
        for (size_t k = pair.first; k < pair.end; ++k) rows.contacts.push_back(rowOf(contacts[order[k]]));
        rows.pairs.push_back(
            {rows.slots[c.a], solid ? NO_SLOT : rows.slots[c.b], first, static_cast<uint32_t>(rows.contacts.size()), c.a, c.b, 0, 0});
        ++rows.colours[pair.colour + 1];
    }
    std::partial_sum(rows.colours.begin(), rows.colours.end(), rows.colours.begin());
    const auto bodiesOf = [](const ContactPair& pair) { return std::tuple(pair.bodyA, pair.bodyB); };
    std::vector<ContactPair> were = before.pairs;
    std::ranges::sort(were, {}, bodiesOf);
    for (const ContactPair& pair : rows.pairs)
        if (const auto was = std::ranges::lower_bound(were, bodiesOf(pair), {}, bodiesOf);
            was != were.end() && bodiesOf(*was) == bodiesOf(pair))
            continueFrom(before, *was, pair, near, rows);
    return rows;
}

std::vector<size_t> outlineOf(std::span<const vec3> places, std::span<const float> separations, const vec3& normal, float flat) {
    std::vector<size_t> all(places.size());
    std::iota(all.begin(), all.end(), size_t{0});
    if (places.size() < 3) return all;
    const vec3 side = glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.6F ? vec3(1, 0, 0) : vec3(0, 1, 0)));
    const vec3 other = glm::cross(normal, side);
    std::vector<dvec2> flatly;
    flatly.reserve(places.size());
    for (const vec3& p : places) flatly.emplace_back(glm::dot(side, p - places[0]), glm::dot(other, p - places[0]));
    if (!isAffine(flatly, separations, flat)) return all;
    // The convex hull, by Andrew's monotone chain.
    std::ranges::sort(all, {}, [&](size_t k) { return std::tuple(flatly[k].x, flatly[k].y); });
    const auto turn = [&](size_t a, size_t b, size_t c) {
        const dvec2 u = flatly[b] - flatly[a], v = flatly[c] - flatly[a];
        return u.x * v.y - u.y * v.x;
    };
    std::vector<size_t> hull;
    for (const bool back : {false, true}) {
        const size_t begin = hull.size();
        for (size_t n = 0; n < all.size(); ++n) {
            const size_t k = all[back ? all.size() - 1 - n : n];
            while (hull.size() >= begin + 2 && turn(hull[hull.size() - 2], hull.back(), k) <= 0) hull.pop_back();
            hull.push_back(k);
        }
        hull.pop_back();
    }
    // The corner that stands out least goes first.
    while (hull.size() > 2) {
        size_t least = 0;
        double out = std::numeric_limits<double>::max();
        for (size_t n = 0; n < hull.size(); ++n) {
            const size_t before = hull[(n + hull.size() - 1) % hull.size()], after = hull[(n + 1) % hull.size()];
            const double span = glm::length(flatly[after] - flatly[before]);
            const double by = span > 0 ? turn(before, hull[n], after) / span : glm::length(flatly[hull[n]] - flatly[before]);
            if (std::abs(by) < out) {
                out = std::abs(by);
                least = n;
            }
        }
        if (out >= double{flat}) break;
        hull.erase(hull.begin() + static_cast<std::ptrdiff_t>(least));
    }
    std::ranges::sort(hull);
    return hull;
}

std::vector<size_t> spreadOf(std::span<const vec3> places, std::span<const float> separations, size_t most) {
    std::vector<size_t> chosen;
    if (places.empty() || most == 0) return chosen;
    const auto deepest = static_cast<size_t>(std::ranges::min_element(separations) - separations.begin());
    std::vector<float> away(places.size(), std::numeric_limits<float>::max());
    chosen.reserve(std::min(most, places.size()));
    for (size_t next = deepest; chosen.size() < std::min(most, places.size());) {
        chosen.push_back(next);
        float best = -std::numeric_limits<float>::max();
        const size_t last = next;
        away[last] = -1;
        for (size_t k = 0; k < places.size(); ++k) {
            if (away[k] < 0) continue;
            away[k] = std::min(away[k], glm::length(places[k] - places[last]));
            // A point that is farther from contact must be farther from the others by as much.
            if (const float worth = away[k] - (separations[k] - separations[deepest]); worth > best) {
                best = worth;
                next = k;
            }
        }
    }
    return chosen;
}

}  // namespace rivulet
