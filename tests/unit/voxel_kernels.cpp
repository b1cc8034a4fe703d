#define RIVULET_KERNEL_UNIT voxel_test_unit
#include "shaders/common/lang.h"
namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {
#include "shaders/voxel/field_params.h"

#include "shaders/voxel/field.h"

#include "shaders/voxel/walk.h"

#include "shaders/fluid/solids/contact.h"

#include "shaders/fluid/solids/contact_thesis.h"
vec3 point(const float* p) { return vec3(p[0], p[1], p[2]); }
}  // namespace
}  // namespace rivulet::RIVULET_KERNEL_UNIT

#include "tests/unit/voxel_kernels.h"

namespace rivulet::test {

using namespace voxel_test_unit;

float walkVoxels(const void* params, const uint32_t* bits, const float* a, const float* b) {
    return voxel_test_unit::walkVoxels(bits, *static_cast<const FieldParams*>(params), point(a), point(b));
}

float walkThesis(const void* params, const uint32_t* bits, const float* a, const float* b) {
    return voxel_test_unit::walkThesis(bits, *static_cast<const FieldParams*>(params), point(a), point(b));
}

float fieldAt(const void* params, const float* distance, const float* p, float* gradient) {
    const FieldSample s = voxel_test_unit::fieldAt(distance, *static_cast<const FieldParams*>(params), point(p));
    gradient[0] = s.gradient.x;
    gradient[1] = s.gradient.y;
    gradient[2] = s.gradient.z;
    return s.distance;
}

bool farFromField(const void* params, const float* distance, const float* a, const float* b) {
    return voxel_test_unit::farFromField(distance, *static_cast<const FieldParams*>(params), point(a), point(b));
}

uint32_t unpackWall(uint32_t code, float* direction) {
    const vec3 n = unpackNormal(code);
    direction[0] = n.x;
    direction[1] = n.y;
    direction[2] = n.z;
    return wallSurface(code);
}

}  // namespace rivulet::test
