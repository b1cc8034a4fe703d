// The calls of OpenCL that wait, counted: this program's own functions of those names stand before the driver's.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace rivulet::testing {

void startClWaits();
// Since then: calls of clFinish and clWaitForEvents, and reads, writes and maps that block. By name; only those that were called.
std::map<std::string, size_t> clWaits();

}  // namespace rivulet::testing
