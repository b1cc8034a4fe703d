// OpenGlTest: a test with an OpenGL context of its own.
#pragma once

#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <cstdlib>
#include <optional>
#include <utility>

#include "engine/app/context_egl.h"

namespace rivulet::testing {

// Without OpenGL a test is skipped; with RIVULET_TEST_DEVICES, as tests/run.sh sets it, it fails.
inline bool mayLackOpenGl() { return std::getenv("RIVULET_TEST_DEVICES") == nullptr; }

// A class that makes more of SetUp() begins with this one's, and goes on if `context_` is there.
class OpenGlTest : public ::testing::Test {
  protected:
    void SetUp() override {
        Result<ContextEgl> context = ContextEgl::create();
        if (!context) {
            ASSERT_TRUE(mayLackOpenGl()) << context.error().message;
            GTEST_SKIP() << context.error().message;
        }
        context_.emplace(std::move(*context));
    }
    void TearDown() override {
        if (context_) EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    }

    std::optional<ContextEgl> context_;
};

}  // namespace rivulet::testing
