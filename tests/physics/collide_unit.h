// The collide kernel compiled as C++ for the tests: threads [begin, end), see shaders/fluid/solids/collide.kernel for the buffers.
#pragma once

#include <cstdint>

namespace rivulet::test {
void collide(uint32_t begin, uint32_t end, const void* params, void* const* buffers);
void collideThesis(uint32_t begin, uint32_t end, const void* params, void* const* buffers);  // fluid.collision.walk "thesis"
}  // namespace rivulet::test
