#include "demos/rivulet/bench_cases.h"

namespace rivulet {

Table<BenchCase> benchCases() { return {}; }

}  // namespace rivulet
