#include "fluid/sim/solid_passes.h"

#include <algorithm>
#include <tuple>

#include "fluid/voxel/labels.h"

namespace rivulet {

Result<SolidPasses> SolidPasses::create(Device& device, const StaticSolids& solids) {
    SolidPasses s;
    s.device_ = &device;
    s.field_ = solids.field != nullptr && !solids.field->empty() ? solids.field : nullptr;
    s.planeSolids_ = solids.planes;
    for (const PlaneSolid& p : s.planeSolids_)
        if (!(glm::length(p.normal) > 0.0F)) return badInput("a plane's normal is zero: give it a direction");
    if (s.field_ != nullptr) s.outside_ = reachableFromBorder(s.field_->surface);

    std::vector<Define> defines;
    if (s.field_ != nullptr) defines = {{"FIELD", "1"}};
    Result<Kernel> boundary = device.kernel("fluid/boundary", defines);
    if (!boundary) return boundary.error();
    s.boundary_ = *boundary;
    std::vector<vec4> planeList;
    for (const PlaneSolid& p : s.planeSolids_) {
        const vec3 n = glm::normalize(p.normal);
        planeList.emplace_back(n, -glm::dot(n, p.position));
    }
    Result<Buffer> planes = device.allocate(std::max<size_t>(planeList.size(), 1) * sizeof(vec4));
    if (!planes) return planes.error();
    s.planes_ = std::move(*planes);
    device.writeAll<vec4>(s.planes_, planeList);
    if (s.field_ == nullptr) return s;
    Result<Kernel> collide = device.kernel("fluid/collide");
    if (!collide) return collide.error();
    s.collide_ = *collide;
    if (Status done = s.upload(); !done) return done.error();
    return s;
}

Status SolidPasses::upload() {
    const std::tuple<Buffer*, const void*, size_t> parts[] = {
        {&fieldBlock_, nullptr, sizeof(FieldParams)},
        {&fieldBits_, field_->surface.bits.data(), field_->surface.bits.size()},
        {&fieldDistance_, field_->distance.data(), field_->distance.size() * sizeof(float)},
        {&fieldNormal_, field_->normal.data(), field_->normal.size() * sizeof(uint32_t)},
    };
    for (auto [buffer, data, bytes] : parts) {
        Result<Buffer> made = device_->allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
        if (data != nullptr) device_->write(*buffer, std::span(static_cast<const std::byte*>(data), bytes));
    }
    return ok();
}

bool SolidPasses::mayBeBorn(const vec3& p, float spacing) const {
    for (const PlaneSolid& plane : planeSolids_)
        if (glm::dot(glm::normalize(plane.normal), p - plane.position) < 0.5F * spacing) return false;
    if (field_ == nullptr) return true;
    const ivec3 voxel = field_->surface.cellOf(p);
    const float contact = fieldParams(*field_, FieldContact{.spacing = spacing}).contact;
    return field_->clearance(p) >= contact && (!field_->surface.contains(voxel) || outside_[field_->surface.index(voxel)] != 0);
}

void SolidPasses::prepare(const FluidParams& params, const StepParams& step, float gravity) {
    if (field_ == nullptr) return;
    block_ = fieldParams(*field_, FieldContact{.spacing = params.spacing,
                                               .friction = params.collision.friction,
                                               .restitution = params.collision.restitution,
                                               .restSpeed = 2.0F * gravity * step.dt,
                                               .countIndex = step.cellCount});
    if (blockDt_ != step.dt) device_->write(fieldBlock_, std::as_bytes(std::span(&block_, 1)));
    blockDt_ = step.dt;
}

void SolidPasses::boundary(const StepParams& step, const NeighborGrid& grid, Particles& particles) {
    if (field_ != nullptr)
        device_->run(boundary_, step,
                     {&grid.cellStart(), &particles.position, &planes_, &particles.boundary, &fieldBlock_, &fieldDistance_},
                     particles.count);
    else
        device_->run(boundary_, step, {&grid.cellStart(), &particles.position, &planes_, &particles.boundary}, particles.count);
}

void SolidPasses::collide(const NeighborGrid& grid, Particles& particles) {
    if (field_ == nullptr) return;
    device_->run(collide_, block_,
                 {&particles.position, &particles.positionNext, &particles.velocityNext, &grid.cellStart(), &fieldBits_, &fieldDistance_,
                  &fieldNormal_},
                 particles.count);
}

}  // namespace rivulet
