// Which small worlds a test runs, and how their answers are compared.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "tests/races/small_worlds.h"

namespace rivulet::races {
namespace {

size_t different(const std::vector<float>& a, const std::vector<float>& b) {
    if (a.size() != b.size()) return std::max(a.size(), b.size());
    size_t count = 0;
    for (size_t k = 0; k < a.size(); ++k) count += std::bit_cast<uint32_t>(a[k]) != std::bit_cast<uint32_t>(b[k]) ? 1 : 0;
    return count;
}

}  // namespace

std::string nameOf(const WorldOn& on) { return std::string(on.device) + "_" + on.world->name; }
std::ostream& operator<<(std::ostream& to, const WorldOn& on) { return to << nameOf(on); }

std::vector<WorldOn> worldsOn(std::initializer_list<const char*> devices, bool (*wanted)(std::string_view device, std::string_view world)) {
    std::vector<WorldOn> all;
    for (const char* device : devices)
        for (const SmallWorld& world : smallWorlds())
            if ((world.onCpu || device != std::string_view("cpu")) && chosen(world) && wanted(device, world.name))
                all.push_back({device, &world});
    return all;
}

void expectSame(const Answer& plain, const Answer& other) {
    EXPECT_EQ(different(plain.exact, other.exact), 0U) << "of " << plain.exact.size() << " values";
    ASSERT_EQ(plain.near.size(), other.near.size());
    float largest = 0;
    for (const float v : plain.near) largest = std::max(largest, std::abs(v));
    for (size_t k = 0; k < plain.near.size(); ++k)
        EXPECT_NEAR(plain.near[k], other.near[k], plain.within * double{largest}) << "value " << k;
}

}  // namespace rivulet::races
