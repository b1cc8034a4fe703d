// Part of every test program: a test fails that uses memory of OpenGL without the glMemoryBarrier that it needs (barriers.h).
#include <gtest/gtest.h>

#include "tests/barriers.h"

namespace {

class BarrierListener : public testing::EmptyTestEventListener {
    void OnTestEnd(const testing::TestInfo&) override {
        for (const std::string& sentence : rivulet::barriers::takeMissing()) ADD_FAILURE() << sentence;
    }
};

const bool kListens = [] {
    testing::UnitTest::GetInstance()->listeners().Append(new BarrierListener);
    return true;
}();

}  // namespace
