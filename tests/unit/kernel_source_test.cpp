// Flattened kernel texts: inlined files, refused texts, and log lines that name the file they come from. The units written for the cpu.
#include "engine/compute/kernel_source.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "engine/compute/embedded_shaders.h"
#include "tests/unit/program_runner.h"

namespace rivulet::kernel_source_test {
namespace {

namespace fs = std::filesystem;

// A folder of shader files that lives as long as a test.
class KernelSourceTest : public ::testing::Test {
  protected:
    KernelSourceTest() {
        root_ = fs::temp_directory_path() / ("rivulet_kernel_source_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
                                             "_" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(root_);
    }
    ~KernelSourceTest() override {
        std::error_code ignored;
        fs::remove_all(root_, ignored);
    }
    void file(const std::string& path, const std::string& text) {
        fs::create_directories((root_ / path).parent_path());
        std::ofstream(root_ / path, std::ios::binary) << text;
    }
    ShaderFiles files() const { return ShaderFiles(root_.string()); }
    Result<KernelSource> flatten(Dialect dialect = Dialect::glsl, std::span<const Define> defines = {},
                                 std::string_view header = {}) const {
        return files().flatten("shaders/a.kernel", defines, dialect, header);
    }
    fs::path root_;
};

size_t occurrences(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
    return count;
}

// Where a compiler that obeys #line believes the first line containing `part` to be: "FILE:LINE" (FILE as #line gives it).
std::string believedPlace(const std::string& text, const std::string& part) {
    std::string file = "?";
    int line = 0;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const std::string one = text.substr(at, end - at);
        at = end + 1;
        if (one.starts_with("#line ")) {
            const size_t space = one.find(' ', 6);
            line = std::stoi(one.substr(6, space - 6));
            file = one.substr(space + 1);
            continue;
        }
        if (one.find(part) != std::string::npos) return file + ":" + std::to_string(line);
        ++line;
    }
    return "nowhere";
}

TEST_F(KernelSourceTest, inlinesIncludesAndKeepsEveryLinesPlace) {
    file("shaders/common/c.h", "#pragma once\nint c;\n");
    file("shaders/b.h", "#include \"shaders/common/c.h\"\n\nint b;\n");
    file("shaders/a.kernel", "// first\n#include \"shaders/b.h\"\nint a1;\n#include \"shaders/common/c.h\"  // again\nint a2;");
    const auto glsl = flatten();
    ASSERT_TRUE(glsl) << glsl.error().message;
    EXPECT_EQ(glsl->files, (std::vector<std::string>{"shaders/a.kernel", "shaders/b.h", "shaders/common/c.h"}));
    EXPECT_EQ(believedPlace(glsl->text, "int a1;"), "0:3");
    EXPECT_EQ(believedPlace(glsl->text, "int a2;"), "0:5");
    EXPECT_EQ(believedPlace(glsl->text, "int b;"), "1:3");
    EXPECT_EQ(believedPlace(glsl->text, "int c;"), "2:2");
    EXPECT_EQ(occurrences(glsl->text, "int c;"), 1U) << "each file is taken once";
    EXPECT_EQ(occurrences(glsl->text, "#pragma once"), 0U);
    EXPECT_EQ(occurrences(glsl->text, "#include"), 0U);
    EXPECT_EQ(glsl->text.back(), '\n');

    const auto opencl = flatten(Dialect::openclC);
    ASSERT_TRUE(opencl);
    EXPECT_EQ(believedPlace(opencl->text, "int b;"), "\"shaders/b.h\":3");
    EXPECT_EQ(believedPlace(opencl->text, "int a2;"), "\"shaders/a.kernel\":5");
}

// A host's kernel names our headers as its C++ compiler finds them; a file has one text whichever name it was included by.
TEST_F(KernelSourceTest, readsThePublicNamesOfHeaders) {
    file("shaders/common/c.h", "int c;\n");
    file("shaders/b.h", "#include \"shaders/common/c.h\"\nint b;\n");
    file("shaders/a.kernel", "#include \"rivulet/shaders/common/c.h\"\n#include \"rivulet/shaders/b.h\"\nint a;\n");
    for (const Dialect dialect : {Dialect::glsl, Dialect::openclC}) {
        const auto source = flatten(dialect);
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ(source->files, (std::vector<std::string>{"shaders/a.kernel", "shaders/common/c.h", "shaders/b.h"}));
        EXPECT_EQ(occurrences(source->text, "int c;"), 1U);
    }
}

TEST_F(KernelSourceTest, headerComesFirstThenDefines) {
    file("shaders/a.kernel", "int a;\n");
    const Define defines[] = {{"LOCAL_SIZE", "256"}, {"THESIS", ""}};
    const auto source = flatten(Dialect::glsl, defines, "#version 450 core");
    ASSERT_TRUE(source);
    EXPECT_TRUE(source->text.starts_with("#version 450 core\n#define LOCAL_SIZE 256\n#define THESIS \n"));
    EXPECT_EQ(believedPlace(source->text, "int a;"), "0:1");
}

TEST_F(KernelSourceTest, leavesOutPartsForCppOnly) {
    file("shaders/shared.h",
         "#if defined(__cplusplus) && !defined(UNIT)\n#include \"engine/core/no_shader.h\"\n#if defined(X)\nint cpp1;\n#else\nint "
         "cpp2;\n#endif\n"
         "#elif defined(__OPENCL_C_VERSION__)\nint gpu1;\n#else\nint gpu2;\n#endif\n#ifdef __cplusplus\nint cpp3;\n#endif\n"
         "#if !defined(__cplusplus)  // a GPU\nint gpu3;\n#else\nint cpp4;\n#endif\n#ifndef __cplusplus\nint gpu4;\n#else\n#include "
         "<math.h>\n#endif\n"
         "int shared;\n");
    file("shaders/a.kernel", "#include \"shaders/shared.h\"\n");
    const auto source = flatten();
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ(source->text.find("cpp1"), std::string::npos);
    EXPECT_EQ(source->text.find("cpp2"), std::string::npos);
    EXPECT_EQ(source->text.find("cpp3"), std::string::npos);
    EXPECT_EQ(source->text.find("cpp4"), std::string::npos);
    EXPECT_EQ(source->text.find("math.h"), std::string::npos);
    for (const char* kept : {"int gpu1;", "int gpu2;", "int gpu3;", "int gpu4;"})
        EXPECT_NE(source->text.find(kept), std::string::npos) << kept;
    EXPECT_EQ(believedPlace(source->text, "int shared;"), "1:26");
    const std::string& text = source->text;  // still balanced
    EXPECT_EQ(occurrences(text, "#if"), occurrences(text, "#endif"));
}

// An include inside a condition must not hide a later one outside it: the first may never be compiled.
TEST_F(KernelSourceTest, conditionalIncludeDoesNotHideALaterOne) {
    file("shaders/b.h", "int b;\n");
    file("shaders/a.kernel", "#if defined(THESIS)\n#include \"shaders/b.h\"\n#endif\n#include \"shaders/b.h\"\n#include \"shaders/b.h\"\n");
    const auto source = flatten();
    ASSERT_TRUE(source);
    EXPECT_EQ(occurrences(source->text, "int b;"), 2U);
    EXPECT_EQ(occurrences(source->text, "#ifndef RIVULET_INCLUDED_1\n"), 2U) << "a guard lets the compiler see it once";
}

TEST_F(KernelSourceTest, missingIncludeNamesFileAndLine) {
    file("shaders/b.h", "\n\n#include \"shaders/gone.h\"\n");
    file("shaders/a.kernel", "#include \"shaders/b.h\"\n");
    const auto source = flatten();
    ASSERT_FALSE(source);
    EXPECT_NE(source.error().message.find("shaders/b.h:3: cannot include \"shaders/gone.h\""), std::string::npos) << source.error().message;
}

TEST_F(KernelSourceTest, circleOfIncludesNamesFileAndLine) {
    file("shaders/b.h", "\n#include \"shaders/a.kernel\"\n");
    file("shaders/a.kernel", "#include \"shaders/b.h\"\n");
    const auto source = flatten();
    ASSERT_FALSE(source);
    EXPECT_NE(source.error().message.find("shaders/b.h:2: "), std::string::npos) << source.error().message;
    EXPECT_NE(source.error().message.find("shaders/a.kernel -> shaders/b.h -> shaders/a.kernel"), std::string::npos)
        << source.error().message;
}

TEST_F(KernelSourceTest, refusesInvalidDirectives) {
    const std::pair<const char*, const char*> cases[] = {
        {"\n#include <math.h>\n", "shaders/a.kernel:2: "},
        {"#include \"open\n", "shaders/a.kernel:1: "},
        {"#include\n", "shaders/a.kernel:1: "},
        {"#if A\n\n", "shaders/a.kernel:2: "},
        {"#endif\n", "shaders/a.kernel:1: "},
        {"\n#else\n", "shaders/a.kernel:2: "},
    };
    for (const auto& [text, place] : cases) {
        file("shaders/a.kernel", text);
        const auto source = flatten();
        ASSERT_FALSE(source) << text;
        EXPECT_TRUE(source.error().message.starts_with(place)) << source.error().message;
    }
    EXPECT_FALSE(files().flatten("shaders/none.kernel", {}, Dialect::glsl));
    EXPECT_FALSE(files().load("shaders"));
}

TEST_F(KernelSourceTest, windowsLineEndsAreNoPartOfALine) {
    file("shaders/b.h", "int b;\r\n");
    file("shaders/a.kernel", "#pragma once\r\n#include \"shaders/b.h\"\r\nint a;\r\n");
    const auto source = flatten();
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ(source->text.find('\r'), std::string::npos);
    EXPECT_EQ(believedPlace(source->text, "int a;"), "0:3");
}

TEST_F(KernelSourceTest, readableLogNamesTheFileALineComesFrom) {
    KernelSource source;
    source.files = {"shaders/fluid/a.kernel", "shaders/common/lang.h", "shaders/fluid/sph.h"};
    EXPECT_EQ(readableLog("2:12(3): error: `x' undeclared\n", source), "shaders/fluid/sph.h:12(3): error: `x' undeclared\n");
    EXPECT_EQ(readableLog("2(12) : error C1008: undefined variable", source), "shaders/fluid/sph.h:12: error C1008: undefined variable");
    EXPECT_EQ(readableLog("ERROR: 1:7: 'y' : undeclared\n0:1(1): warning: z\n", source),
              "ERROR: shaders/common/lang.h:7: 'y' : undeclared\nshaders/fluid/a.kernel:1(1): warning: z\n");
    source.text =
        "#define A 1\n#line 1 \"shaders/fluid/a.kernel\"\none\n#line 5 \"shaders/fluid/sph.h\"\nfive\nsix\n#line 3 "
        "\"shaders/fluid/a.kernel\"\nthree\n";
    EXPECT_EQ(readableLog("<kernel>:3:7: error: one\n<kernel>:6:1: error: six\n<kernel>:8:2: three\n", source),
              "shaders/fluid/a.kernel:1:7: error: one\nshaders/fluid/sph.h:6:1: error: six\nshaders/fluid/a.kernel:3:2: three\n");
    for (const char* plain : {"", "\n\n", "<kernel>:1:2: error", "<kernel>", "error: linking failed", "9:12(3): error", "2:", "2(", "2(12",
                              "12", "shaders/fluid/sph.h:12:3: error", "99999999999999999999:1: x"})
        EXPECT_EQ(readableLog(plain, source), plain);
}

TEST(KernelSource, shortLogLeavesWarningsOutAndEnds) {
    EXPECT_EQ(shortLog(""), "");
    EXPECT_EQ(shortLog("a.kernel:1:2: warning: unused\n  int x;\n  ^\na.kernel:3:4: error: no\n  y\n  ^"),
              "a.kernel:3:4: error: no\n  y\n  ^");
    EXPECT_EQ(shortLog("a.kernel:1:2: error: no\n  y\na.kernel:3:4: warning: unused\n  int x;"), "a.kernel:1:2: error: no\n  y");
    // Without an error all there is may be the reason.
    EXPECT_EQ(shortLog("a.kernel:1:2: warning: odd\n  x"), "a.kernel:1:2: warning: odd\n  x");
    EXPECT_EQ(shortLog("the linker: terror: out of registers"), "the linker: terror: out of registers");
    std::string many;
    for (int k = 0; k < 100; ++k) many += "a.kernel:" + std::to_string(k) + ": error: no\n";
    const std::string cut = shortLog(many);
    EXPECT_NE(cut.find("a.kernel:39: error: no\n... and 60 more lines"), std::string::npos) << cut;
    EXPECT_EQ(cut.find("a.kernel:40:"), std::string::npos);
    EXPECT_LT(shortLog("error: " + std::string(100000, 'x')).size(), 500U);
}

TEST(ShaderFilesTest, embeddedFilesAreTheOnesOnDisk) {
    std::set<std::string> embedded;
    for (const EmbeddedShader& row : embeddedShaders()) {
        embedded.insert(row.path);
        std::ifstream onDisk(fs::path(RIVULET_SOURCE_DIR) / row.path, std::ios::binary);
        EXPECT_EQ(std::string(std::istreambuf_iterator<char>(onDisk), {}), row.text) << row.path;
    }
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(RIVULET_SOURCE_DIR) / "shaders")) {
        if (!entry.is_regular_file()) continue;
        EXPECT_TRUE(embedded.contains(fs::relative(entry.path(), RIVULET_SOURCE_DIR).generic_string())) << entry.path();
    }
    const ShaderFiles installed;
    EXPECT_TRUE(installed.load("shaders/common/lang.h"));
    const auto missing = installed.load("shaders/common/lung.h");
    ASSERT_FALSE(missing);
    EXPECT_NE(missing.error().message.find("shaders/common/lung.h"), std::string::npos);
}

TEST(ShaderFilesTest, filesOnDiskComeFirstAndEmbeddedOnesFillTheGaps) {
    const fs::path root = fs::temp_directory_path() / "rivulet_shader_files_test";
    fs::create_directories(root / "shaders/common");
    std::ofstream(root / "shaders/common/lang.h") << "edited";
    setenv("RIVULET_SHADERS", root.c_str(), 1);
    const ShaderFiles files = ShaderFiles::developer();
    unsetenv("RIVULET_SHADERS");
    ASSERT_TRUE(files.load("shaders/common/lang.h"));
    EXPECT_EQ(*files.load("shaders/common/lang.h"), "edited");
    EXPECT_TRUE(files.load("shaders/common/lang_cpp.h"));
    fs::remove_all(root);
}

TEST(ShaderFilesTest, everyKernelFlattensWithoutTheCppSide) {
    for (const EmbeddedShader& row : embeddedShaders()) {
        if (!std::string_view(row.path).ends_with(".kernel")) continue;
        for (const Dialect dialect : {Dialect::glsl, Dialect::openclC}) {
            const auto source = ShaderFiles().flatten(row.path, {}, dialect);
            ASSERT_TRUE(source) << source.error().message;
            for (const std::string& file : source->files) EXPECT_NE(file, "shaders/common/lang_cpp.h") << row.path;
        }
    }
}

// What engine/compute/compile_kernels.cmake writes for the cpu from the line above KERNEL.
class CompileKernelsTest : public KernelSourceTest {
  protected:
    testing::Outcome write() {
        return testing::runCommand({"cmake", "-DROOT=" + root_.string(), "-DOUT=" + (root_ / "out").string(), "-DISAS=generic,avx2", "-P",
                                    RIVULET_SOURCE_DIR "/engine/compute/compile_kernels.cmake"});
    }
    std::string written(const std::string& name) const {
        std::ifstream in(root_ / "out" / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::vector<std::string> rows() const {
        std::vector<std::string> found;
        std::istringstream lines(written("kernel_table.cpp"));
        for (std::string line; std::getline(lines, line);)
            if (line.find("Isa::avx2") != std::string::npos) found.push_back(line.substr(5, line.find(", Isa") - 5));
        return found;
    }
};

TEST_F(CompileKernelsTest, ATextsOwnLineGivesTheFormsThatAreCompiled) {
    file("shaders/fluid/one.kernel", "// One.\n// cpu 1024\nKERNEL(one, P)\n{\n}\n");
    file("shaders/fluid/pair.kernel", "#define ARGS(RO, RW) \\\n    RO(1, A, uint, a)\n// cpu 64: B? A? | C A\nKERNEL(pair, P)\n{\n}\n");
    file("shaders/fluid/sort.kernel", "// gpu only\nKERNEL(sort, P)\n{\n}\n");
    file("shaders/fluid/shared.h", "// Shared.\n#define LENGTH 3\n#define WIDTH(x) \\\n    (x)\n");
    const testing::Outcome run = write();
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(rows(), (std::vector<std::string>{R"("fluid/one", "")", R"("fluid/pair", "")", R"("fluid/pair", "B=1")",
                                                R"("fluid/pair", "A=1")", R"("fluid/pair", "A=1;B=1")", R"("fluid/pair", "A=1;C=1")"}));
    EXPECT_NE(written("kernel_table.cpp").find("Isa::generic, kernels_generic::fluid_pair_A_C::pair, 64}"), std::string::npos);
    EXPECT_EQ(written("undefine.h"), "#undef LENGTH\n#undef WIDTH\n");
    const std::string unit = written("fluid.cpp");
    EXPECT_NE(unit.find("#define A 1\n#define C 1\nnamespace fluid_pair_A_C {\n#include \"shaders/fluid/pair.kernel\"\n}\n"
                        "#undef A\n#undef C\n#undef ARGS\n"),
              std::string::npos)
        << unit;
}

TEST_F(CompileKernelsTest, AChangedTextLeavesTheWrittenFilesAlone) {
    file("shaders/fluid/one.kernel", "// One.\n// cpu 1024\nKERNEL(one, P)\n{\n}\n");
    ASSERT_EQ(write().code, 0);
    const fs::path unit = root_ / "out/fluid.cpp";
    fs::last_write_time(unit, fs::last_write_time(unit) - std::chrono::hours(1));
    const auto before = fs::last_write_time(unit);
    file("shaders/fluid/one.kernel", "// One, better.\n// cpu 1024\nKERNEL(one, P)\n{\n}\n");
    ASSERT_EQ(write().code, 0);
    EXPECT_EQ(fs::last_write_time(unit), before);
    file("shaders/fluid/one.kernel", "// One.\n// cpu 1024: A?\nKERNEL(one, P)\n{\n}\n");
    ASSERT_EQ(write().code, 0);
    EXPECT_NE(fs::last_write_time(unit), before);
}

TEST_F(CompileKernelsTest, ATextWithoutALineOrWithAWrongOneIsRefused) {
    for (const char* line : {"", "// cpu\n", "// cpu 0\n", "// cpu 64 A?\n", "// cpu 64: a\n", "// cpus 64\n", "// gpu\n"}) {
        file("shaders/fluid/one.kernel", std::string("// One.\n") + line + "KERNEL(one, P)\n{\n}\n");
        const testing::Outcome run = write();
        EXPECT_NE(run.code, 0) << line;
        EXPECT_NE(run.err.find("shaders/fluid/one.kernel"), std::string::npos) << run.err;
    }
    file("shaders/fluid/one.kernel", "// cpu 64\nKERNEL(two, P)\n{\n}\n");
    EXPECT_NE(write().code, 0) << "a kernel is named as its file is";
}

}  // namespace
}  // namespace rivulet::kernel_source_test
