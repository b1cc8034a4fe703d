#include "fluid/sim/solids/body_contacts.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>

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
    return {
        vec4(c.onA, c.radiusA), vec4(c.onB, c.radiusB), vec4(c.normal, c.friction), vec4(c.velocityB, c.restitution), NO_CONTACT, 0, 0, 0};
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
    for (const ContactPair& pair : rows.pairs) {
        const auto was =
            std::ranges::find_if(before.pairs, [&](const ContactPair& old) { return old.bodyA == pair.bodyA && old.bodyB == pair.bodyB; });
        if (was == before.pairs.end()) continue;
        std::vector<bool> taken(was->end - was->first);
        for (uint32_t k = pair.first; k < pair.end; ++k) {
            float least = near;
            for (uint32_t old = was->first; old < was->end; ++old) {
                // A ball's contacts turn with it: only those of its partner tell them apart.
                const bool ball = rows.contacts[k].onA.w > 0;
                const vec4 &there = ball ? before.contacts[old].onB : before.contacts[old].onA,
                           &here = ball ? rows.contacts[k].onB : rows.contacts[k].onA;
                const float apart = glm::length(vec3(here) - vec3(there));
                if (taken[old - was->first] || !(apart < least)) continue;
                if (glm::dot(vec3(rows.contacts[k].normal), vec3(before.contacts[old].normal)) < 0.9F) continue;
                least = apart;
                rows.contacts[k].before = old;
            }
            if (rows.contacts[k].before != NO_CONTACT) taken[rows.contacts[k].before - was->first] = true;
        }
    }
    return rows;
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
