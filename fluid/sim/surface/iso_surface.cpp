// Anisotropic kernels after Yu & Turk 2013 "Reconstructing surfaces of particle-based fluids using anisotropic kernels"; the level kept as
// by Vollmer, Mencl & Mueller 1999 "Improved Laplacian smoothing of noisy surface meshes".
#include "fluid/sim/surface/iso_surface.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"

namespace rivulet {

namespace {

// The neighbourhood of each particle: cells as wide as the support.
struct Neighborhood {
    std::span<const dvec3> at;
    double support;  // m
    SparseCells cells;

    Neighborhood(std::span<const dvec3> positions, double reach) : at(positions), support(reach) {
        cells.build(static_cast<uint32_t>(at.size()), support,
                    [&](uint32_t i, const auto& add) { add(ivec3(glm::floor(at[i] / support))); });
    }
    // each(j, weight) of those nearer than the support, i itself included.
    template <class Each>
    void around(uint32_t i, const Each& each) const {
        const ivec3 home = cells.cellOf(at[i]);
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x)
                    for (const uint32_t j : cells.items(home + ivec3(x, y, z))) {
                        const double q = glm::length(at[j] - at[i]) / support;
                        if (q < 1) each(j, 1 - q * q * q);
                    }
    }
};

// How far each particle is from the mean of its neighbours.
std::vector<dvec3> offsetsOf(const Neighborhood& near) {
    std::vector<dvec3> offsets(near.at.size());
    parallelFor(uint32_t{0}, static_cast<uint32_t>(near.at.size()), [&](uint32_t i) {
        dvec3 sum(0.0);
        double weights = 0;
        near.around(i, [&](uint32_t j, double w) {
            sum += w * (near.at[j] - near.at[i]);
            weights += w;
        });
        offsets[i] = sum / weights;
    });
    return offsets;
}

// At a surface all centres move inward. What a particle's neighbours move by in its own direction it is put back by.
dvec3 sharedOffset(const Neighborhood& near, std::span<const dvec3> offsets, uint32_t i) {
    dvec3 sum(0.0);
    double weights = 0;
    near.around(i, [&](uint32_t j, double w) {
        const double alike = j == i ? 0.0 : w * std::max(glm::dot(offsets[i], offsets[j]), 0.0);
        sum += alike * offsets[j];
        weights += alike;
    });
    return weights > 0 ? sum / weights : dvec3(0.0);
}

struct Axes {
    dvec3 direction[3];
    dvec3 length{1.0};  // relative to a round particle's
};

Axes axesOf(const Neighborhood& near, uint32_t i, const dvec3& offset, double spacing) {
    const dvec3 mean = near.at[i] + offset;
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    double weights = 0;
    near.around(i, [&](uint32_t j, double w) {
        const dvec3 d = near.at[j] - mean;
        const Eigen::Vector3d e(d.x, d.y, d.z);
        c += w * e * e.transpose();
        weights += w;
    });
    const double full = double{ANISOTROPY_FULL} * near.support * near.support;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(c / (weights * full));
    Axes axes;
    const double alone = double{ANISOTROPY_ALONE};
    const double crowd = double{ANISOTROPY_CROWD} * std::pow(near.support / spacing, 3);
    const double share = weights / crowd;
    const double together = std::clamp((share - double{ANISOTROPY_FEW}) / double{ANISOTROPY_MANY - ANISOTROPY_FEW}, 0.0, 1.0);
    const double longest = std::sqrt(std::max(solved.eigenvalues()[2], 0.0));
    for (int k = 0; k < 3; ++k) {
        const auto v = solved.eigenvectors().col(k);
        axes.direction[k] = dvec3(v[0], v[1], v[2]);
        const double own = std::max(std::sqrt(std::max(solved.eigenvalues()[k], 0.0)), longest / double{ANISOTROPY_RATIO});
        axes.length[k] = alone + together * (own - alone);
    }
    return axes;
}

}  // namespace

Result<IsoSurface> IsoSurface::create(std::span<const vec4> particles, float spacing, const IsoSurfaceParams& params) {
    if (!(spacing > 0))
        return badInput(fmt::format("a surface of particles needs their spacing in metres, more than 0; it was {}", spacing));
    if (!(params.support > 0) || !(params.kernel > 0) || !(params.smoothing >= 0 && params.smoothing <= 1))
        return badInput("a surface of particles needs a support and a kernel of more than 0 spacings and a smoothing of 0 to 1");
    IsoSurface made;
    made.spacing_ = double{spacing};
    const double s = made.spacing_, furthest = 1.0e6 * s;
    std::vector<dvec3> at;
    for (const vec4& p : particles)
        if (p.w >= 0 && glm::all(glm::lessThan(glm::abs(dvec3(p)), dvec3(furthest)))) at.emplace_back(p);
    const Neighborhood near(at, params.support * s);
    const std::vector<dvec3> offsets = offsetsOf(near);
    made.kernels_.resize(at.size());
    const double round = params.kernel * s;
    parallelFor(uint32_t{0}, made.count(), [&](uint32_t i) {
        const Axes axes = axesOf(near, i, offsets[i], s);
        Kernel& k = made.kernels_[i];
        k.centre = at[i] + params.smoothing * (offsets[i] - sharedOffset(near, offsets, i));
        double volume = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double half = round * axes.length[axis];
            const dvec3& d = axes.direction[axis];
            k.xx += d.x * d.x / half;
            k.yy += d.y * d.y / half;
            k.zz += d.z * d.z / half;
            k.xy += d.x * d.y / half;
            k.xz += d.x * d.z / half;
            k.yz += d.y * d.z / half;
            volume *= half;
            k.reach = std::max(k.reach, half);
        }
        k.peak = 21 / (2 * glm::pi<double>()) * s * s * s / volume;
    });
    made.cells_.build(made.count(), s, [&](uint32_t i, const auto& add) {
        const Kernel& k = made.kernels_[i];
        const ivec3 low(glm::floor((k.centre - k.reach) / s)), high(glm::floor((k.centre + k.reach) / s));
        for (int z = low.z; z <= high.z; ++z)
            for (int y = low.y; y <= high.y; ++y)
                for (int x = low.x; x <= high.x; ++x) {
                    const dvec3 corner = s * dvec3(x, y, z);
                    const dvec3 away = k.centre - glm::clamp(k.centre, corner, corner + s);
                    if (glm::dot(away, away) < k.reach * k.reach) add(ivec3(x, y, z));
                }
    });
    return made;
}

IsoSurface::Sample IsoSurface::sample(const dvec3& p) const {
    Sample all;
    for (const uint32_t i : cells_.items(cells_.cellOf(p))) {
        const Kernel& k = kernels_[i];
        const dvec3 d = p - k.centre;
        const dvec3 y(k.xx * d.x + k.xy * d.y + k.xz * d.z, k.xy * d.x + k.yy * d.y + k.yz * d.z, k.xz * d.x + k.yz * d.y + k.zz * d.z);
        const double q2 = glm::dot(y, y);
        if (q2 >= 1) continue;
        const double q = std::sqrt(q2), a = 1 - q, a3 = a * a * a;
        all.value += k.peak * a3 * a * (4 * q + 1);
        // (a^4 (4 q + 1))' = -20 q a^3, and the gradient of q is G y / q.
        all.gradient -=
            20 * k.peak * a3 *
            dvec3(k.xx * y.x + k.xy * y.y + k.xz * y.z, k.xy * y.x + k.yy * y.y + k.yz * y.z, k.xz * y.x + k.yz * y.y + k.zz * y.z);
    }
    return all;
}

double IsoSurface::Kernel::value(const dvec3& p) const {
    const dvec3 d = p - centre;
    const dvec3 y(xx * d.x + xy * d.y + xz * d.z, xy * d.x + yy * d.y + yz * d.z, xz * d.x + yz * d.y + zz * d.z);
    const double q2 = glm::dot(y, y);
    if (q2 >= 1) return 0;
    const double q = std::sqrt(q2), a2 = (1 - q) * (1 - q);
    return peak * a2 * a2 * (4 * q + 1);
}

double IsoSurface::value(const dvec3& p) const {
    double sum = 0;
    for (const uint32_t i : cells_.items(cells_.cellOf(p))) sum += kernels_[i].value(p);
    return sum;
}

dvec3 IsoSurface::normal(const dvec3& p) const {
    const dvec3 g = sample(p).gradient;
    const double length = glm::length(g);
    return length > 0 ? -g / length : dvec3(0, 1, 0);
}

}  // namespace rivulet
