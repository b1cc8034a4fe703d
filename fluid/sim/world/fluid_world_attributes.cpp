// The values that a host gives to each particle, while the world runs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "fluid/sim/sources/attributes.h"
#include "fluid/sim/world/fluid_world_impl.h"
#include "shaders/fluid/world/attribute_write.h"

namespace rivulet {

namespace {

bool finite(const vec4& v) { return isFinite(vec3(v)) && std::isfinite(v.w); }

// Of a write that a stop would skip.
Status stopped(const Device& device) {
    if (!device.interrupted() && !device.stopAsked()) return ok();
    return failed("the attributes were not set, because a stop was asked: end the stop, then set them again");
}

Status known(const FluidParams& params, size_t attribute) {
    if (attribute < params.attributes.size()) return ok();
    return badInput(fmt::format("there is no attribute {}: fluid.attributes has {}", attribute, params.attributes.size()));
}

}  // namespace

// Those of t = 0: a free slot has the values of the world, until an emitter fills it.
void FluidWorld::Impl::writeAttributes() {
    constexpr uint32_t kPiece = 65536;
    std::vector<vec4> values;
    for (size_t a = 0; a < params.attributes.size(); ++a) {
        const AttributeParams& attribute = params.attributes[a];
        std::vector<vec4> ofBlocks;
        ofBlocks.reserve(params.blocks.size());
        for (const BlockParams& b : params.blocks) ofBlocks.push_back(attributeOf(attribute, b.attributes));
        for (uint32_t first = 0; first < particles.count; first += kPiece) {
            values.assign(std::min(kPiece, particles.count - first), attribute.value());
            for (size_t k = first; k < std::min(first + values.size(), start.size()); ++k)
                if (start[k].block != kNoBlock) values[k - first] = ofBlocks[start[k].block];
            device->write(particles.attributesOf[a], std::as_bytes(std::span(values)), size_t{first} * sizeof(vec4));
        }
    }
}

void FluidWorld::Impl::attributesChanged() {
    if (sleep) painted = {grid->sleepers(), std::make_shared<char>()};
    gatherForDrawing();
    change();
}

Status FluidWorld::setAttribute(size_t attribute, std::span<const uint32_t> ids, std::span<const vec4> values) {
    Impl& w = *impl_;
    if (Status s = w.whole(); !s) return s;
    if (Status s = known(w.params, attribute); !s) return s;
    if (ids.size() != values.size())
        return badInput(fmt::format("{} values were given for {} particles: give one for each", values.size(), ids.size()));
    for (size_t k = 0; k < ids.size(); ++k) {
        if (ids[k] >= w.slots)
            return badInput(fmt::format("ids[{}] is {}, and ids are below {}: use those of the particles now", k, ids[k], w.slots));
        if (!finite(values[k])) return badInput(fmt::format("values[{}] of attribute {} is not finite: correct it", k, attribute));
    }
    if (ids.empty()) return ok();
    for (auto [buffer, bytes] : {std::pair(&w.attributeIds, ids.size_bytes()), std::pair(&w.attributeValues, values.size_bytes())}) {
        if (buffer->bytes() >= bytes) continue;
        Result<Buffer> made = w.device->allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    w.device->goOn();  // another owner of buffers may have been interrupted
    if (Status s = stopped(*w.device); !s) return s;
    w.device->writeAll<uint32_t>(w.attributeIds, ids);
    w.device->writeAll<vec4>(w.attributeValues, values);
    AttributeWrite block{};
    block.count = static_cast<uint32_t>(ids.size());
    w.device->run(w.setAttribute, block, {&w.attributeIds, &w.attributeValues, &w.particles.attributesOf[attribute]}, block.count);
    w.attributesChanged();
    return stopped(*w.device);
}

Status FluidWorld::paint(size_t attribute, const Volume& inside, const vec4& value) {
    Impl& w = *impl_;
    if (Status s = w.whole(); !s) return s;
    if (Status s = known(w.params, attribute); !s) return s;
    if (Status s = checkVolume(inside, "the volume to paint"); !s) return s;
    if (!finite(value)) return badInput(fmt::format("the value of attribute {} is not finite: correct it", attribute));
    w.device->goOn();
    if (Status s = stopped(*w.device); !s) return s;
    AttributeWrite block{};
    block.inside = shapeOf(inside);
    block.value = value;
    block.count = w.particles.count;
    w.device->run(w.paintAttribute, block, {&w.particles.id, &w.particles.positionNext, &w.particles.attributesOf[attribute]}, block.count);
    w.attributesChanged();
    return stopped(*w.device);
}

}  // namespace rivulet
