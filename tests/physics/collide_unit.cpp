#define RIVULET_KERNEL_UNIT collide_test_unit
#include "shaders/common/lang.h"
namespace rivulet::RIVULET_KERNEL_UNIT {
namespace still {
#include "shaders/fluid/solids/collide.kernel"
}
#define THESIS 1
namespace thesis {
#include "shaders/fluid/solids/collide.kernel"
}
#undef THESIS
}  // namespace rivulet::RIVULET_KERNEL_UNIT

#include "tests/physics/collide_unit.h"

namespace rivulet::test {
void collide(uint32_t begin, uint32_t end, const void* params, void* const* buffers) {
    collide_test_unit::still::collide(begin, end, params, buffers);
}
void collideThesis(uint32_t begin, uint32_t end, const void* params, void* const* buffers) {
    collide_test_unit::thesis::collide(begin, end, params, buffers);
}
}  // namespace rivulet::test
