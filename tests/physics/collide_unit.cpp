#define RIVULET_KERNEL_UNIT collide_test_unit
#include "shaders/common/lang.h"
namespace rivulet::RIVULET_KERNEL_UNIT {
#include "shaders/fluid/collide.kernel"
}

#include "tests/physics/collide_unit.h"

namespace rivulet::test {
void collide(uint32_t begin, uint32_t end, const void* params, void* const* buffers) {
    collide_test_unit::collide(begin, end, params, buffers);
}
}  // namespace rivulet::test
