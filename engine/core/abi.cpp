#define RIVULET_DEFINES_ABI
#include "engine/core/abi.h"

namespace rivulet::library {

const char RIVULET_BUILT = 0;

}  // namespace rivulet::library
