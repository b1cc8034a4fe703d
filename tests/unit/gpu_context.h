// Shared by tests with OpenGL: a headless context, and a check that the driver reports no errors.
#pragma once

#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "engine/app/context_egl.h"
#include "engine/gpu/debug.h"

namespace rivulet {

class GpuTest : public ::testing::Test {
  protected:
    void SetUp() override {
        GTEST_FLAG_SET(death_test_style, "threadsafe");  // the driver has threads: no fork in the middle
        Result<ContextEgl> context = ContextEgl::create({.debug = true});
        ASSERT_TRUE(context) << context.error().message;
        context_.emplace(std::move(*context));
        messages_.emplace(Log{[this](LogLevel level, std::string_view text) {
            if (level >= LogLevel::warning) said_ += std::string(text) + "\n";
        }});
    }
    void TearDown() override {
        if (messages_) {
            EXPECT_EQ(messages_->errors(), 0) << said_;
        }
    }
    // Memory that this process holds, in bytes.
    static size_t residentBytes() {
        size_t total = 0, resident = 0;
        std::ifstream("/proc/self/statm") >> total >> resident;
        return resident * static_cast<size_t>(sysconf(_SC_PAGESIZE));
    }
    // A folder of its own, to be read as ShaderFiles(root()).
    const std::string& root() {
        if (root_.empty()) {
            std::string path = (std::filesystem::temp_directory_path() / "rivulet_gpu_XXXXXX").string();
            EXPECT_NE(mkdtemp(path.data()), nullptr);
            root_ = path;
        }
        return root_;
    }
    void writeFile(const std::string& path, const std::string& text) {
        const std::filesystem::path file = std::filesystem::path(root()) / path;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }
    ~GpuTest() override {
        std::error_code ignored;
        if (!root_.empty()) std::filesystem::remove_all(root_, ignored);
    }

    std::optional<ContextEgl> context_;
    std::optional<gpu::DebugMessages> messages_;
    std::string said_;

  private:
    std::string root_;
};

}  // namespace rivulet
