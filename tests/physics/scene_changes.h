// Changes of a random scene, and the distance of two answers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/physics/random_scenes.h"

namespace rivulet::relations {

// A signed permutation of the axes: one of the 48 rotations and reflections of a cube.
struct Turn {
    std::array<int, 3> from{0, 1, 2};
    vec3 sign{1.0F};
    vec3 operator()(const vec3& a) const { return {sign.x * a[from[0]], sign.y * a[from[1]], sign.z * a[from[2]]}; }
    static Turn random(Dice& dice) {
        Turn t;
        while (t.from == std::array{0, 1, 2} && t.sign == vec3(1.0F)) {
            for (int k = 2; k > 0; --k) std::swap(t.from[static_cast<size_t>(k)], t.from[static_cast<size_t>(dice.whole(0, k))]);
            for (int k = 0; k < 3; ++k) t.sign[k] = dice.whole(0, 1) == 0 ? -1.0F : 1.0F;
        }
        return t;
    }
};

inline RandomScene turned(const Turn& turn, const RandomScene& s) {
    RandomScene t = s;
    const auto corners = [&](vec3& low, vec3& high) {
        const vec3 a = turn(low), b = turn(high);
        low = glm::min(a, b);
        high = glm::max(a, b);
    };
    corners(t.params.box.min, t.params.box.max);
    for (BlockParams& b : t.params.blocks) corners(b.min, b.max);
    t.params.gravity = turn(s.params.gravity);
    bool* const periodic[] = {&t.params.box.periodicX, &t.params.box.periodicY, &t.params.box.periodicZ};
    for (size_t k = 0; k < 3; ++k) *periodic[k] = s.params.box.periodic()[turn.from[k]];
    for (vec3& x : t.x) x = turn(x);
    for (vec3& v : t.v) v = turn(v);
    return t;
}

// Lengths times `by`, times and speeds times its root: gravity stays, and the Froude number does.
inline RandomScene scaled(float by, const RandomScene& s) {
    RandomScene t = s;
    const float root = std::sqrt(by);
    FluidParams& p = t.params;
    p.spacing *= by;
    p.box.min *= by;
    p.box.max *= by;
    p.soundSpeed *= root;
    for (BlockParams& b : p.blocks) {
        b.min *= by;
        b.max *= by;
        b.velocity *= root;
    }
    p.stiffness *= by;  // of wcsph_thesis: the square of a speed
    for (vec3& x : t.x) x *= by;
    for (vec3& v : t.v) v *= root;
    t.dt *= std::sqrt(double{by});
    return t;
}

// A second copy of everything, `by` away.
inline RandomScene twice(const RandomScene& s, const vec3& by) {
    RandomScene t = s;
    for (BlockParams b : s.params.blocks) {
        b.min += by;
        b.max += by;
        t.params.blocks.push_back(b);
    }
    for (const vec3& x : s.x) t.x.push_back(x + by);
    t.v.insert(t.v.end(), s.v.begin(), s.v.end());
    return t;
}

// Places changed by one rounding error each.
inline RandomScene nudged(const RandomScene& s, Dice& dice) {
    RandomScene t = s;
    for (vec3& x : t.x)
        for (int k = 0; k < 3; ++k) x[k] = std::nextafter(x[k], dice.whole(0, 1) == 0 ? -1.0e3F : 1.0e3F);
    return t;
}

// Distances of particles with the same id, in spacings; on a periodic axis between the nearest images.
struct Apart {
    double mean = 0, worst = 0;
};
inline Apart apart(const RandomScene& s, const std::vector<vec3>& x, const std::vector<vec3>& y) {
    EXPECT_EQ(x.size(), y.size());
    const dvec3 size(s.params.box.max - s.params.box.min);
    Apart a;
    const size_t n = std::min(x.size(), y.size());
    for (size_t i = 0; i < n; ++i) {
        dvec3 d = dvec3(y[i]) - dvec3(x[i]);
        for (int k = 0; k < 3; ++k)
            if (s.params.box.periodic()[k]) d[k] -= std::round(d[k] / size[k]) * size[k];
        const double far = glm::length(d) / double{s.params.spacing};
        a.mean += far / static_cast<double>(n);
        a.worst = std::max(a.worst, far);
    }
    return a;
}

// The same values, each changed by `map`.
template <class Map>
std::vector<vec3> mapped(const std::vector<vec3>& x, Map&& map) {
    std::vector<vec3> y;
    for (const vec3& at : x) y.push_back(map(at));
    return y;
}

}  // namespace rivulet::relations
