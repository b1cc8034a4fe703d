// Which OpenGL a test has: a suite for one driver must not pass on another one.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace rivulet {

// Fails the test if RIVULET_EXPECT_RENDERER is set and `renderer`, an OpenGL's GL_RENDERER, does not have that text in it.
inline void expectRenderer(const std::string& renderer) {
    const char* wanted = std::getenv("RIVULET_EXPECT_RENDERER");
    if (wanted == nullptr || renderer.find(wanted) != std::string::npos) return;
    ADD_FAILURE() << "OpenGL here is '" << renderer << "', and RIVULET_EXPECT_RENDERER asks for '" << wanted
                  << "' in that name: install that driver, or unset the variable";
}

}  // namespace rivulet
