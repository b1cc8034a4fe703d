// The values that a host gives to each particle (FluidParams::attributes), of the blocks and emitters that particles come from.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

// Error (badInput): more than kMostAttributes, a name that is empty or there twice; a block that names another attribute.
Status checkAttributes(const FluidParams& params);
// Of a block or emitter, `where`: whether `own` names attributes of `all`.
Status checkAttributes(std::span<const AttributeParams> all, std::span<const AttributeParams> own, const std::string& where);
Status checkAttributes(std::span<const AttributeParams> all, std::span<const LiveAttributeParams> own, const std::string& where);
// The value of an attribute of the world that the particles of a block or emitter have.
vec4 attributeOf(const AttributeParams& of, std::span<const AttributeParams> own);
vec4 attributeOf(const AttributeParams& of, std::span<const LiveAttributeParams> own);

}  // namespace rivulet
