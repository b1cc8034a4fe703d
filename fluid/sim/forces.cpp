#include "fluid/sim/force.h"

namespace rivulet {

Table<ForceRow> forces() { return {}; }

}  // namespace rivulet
