// Functions of shaders/voxel in the kernel language, for tests: `params` is a FieldParams, points are three floats.
#pragma once

#include <cstdint>

namespace rivulet::test {

// In cell coordinates; see shaders/voxel/walk.h.
float walkVoxels(const void* params, const uint32_t* bits, const float* a, const float* b);
float walkThesis(const void* params, const uint32_t* bits, const float* a, const float* b);  // see shaders/fluid/solids/contact_thesis.h
// In metres; see shaders/voxel/field.h. Returns the distance.
float fieldAt(const void* params, const float* distance, const float* point, float* gradient);
bool farFromField(const void* params, const float* distance, const float* a, const float* b);
// See shaders/fluid/solids/contact_walls.h. Returns the surface.
uint32_t unpackWall(uint32_t code, float* direction);

}  // namespace rivulet::test
