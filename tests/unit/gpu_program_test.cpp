// Programs: errors name the file and line they come from, a failed reload changes nothing.
#include <rivulet_glad/gl.h>

#include "engine/gpu/framebuffer.h"
#include "engine/gpu/program.h"
#include "engine/gpu/vertex_array.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::gpu::gpu_program_test {
namespace {

constexpr const char* kCover = "void main() { gl_Position = vec4(vec2(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1), 0, 1); }\n";

class GpuProgram : public GpuTest {
  protected:
    void SetUp() override {
        GpuTest::SetUp();
        writeFile("shaders/cover.vert", kCover);
    }
    Result<Program> load(std::vector<Define> defines = {}) {
        return Program::create(ShaderFiles(root()), {"shaders/cover.vert", "shaders/paint.frag"}, std::move(defines));
    }
    vec4 paint(const Program& program) {
        Result<Texture> texture = Texture::create({.width = 2, .height = 2, .format = Format::rgba32f});
        EXPECT_TRUE(texture);
        const Framebuffer target(*texture, nullptr);
        target.bind();
        const VertexArray none = VertexArray::create();
        none.bind();
        program.use();
        glDrawArrays(GL_TRIANGLES, 0, 3);
        std::vector<vec4> texels(4);
        texture->read(std::as_writable_bytes(std::span(texels)));
        EXPECT_EQ(texels[0], texels[3]);
        return texels[0];
    }
};

TEST_F(GpuProgram, DrawsWithItsUniformsAndDefines) {
    writeFile("shaders/colours.h", "struct Tint { vec3 rgb; };\nvec4 colour(Tint t, float alpha) { return vec4(t.rgb, alpha); }\n");
    writeFile("shaders/paint.frag",
              "#include \"shaders/colours.h\"\n"
              "out vec4 result;\nuniform Tint tint; uniform float alphas[3]; uniform sampler2D unused;\n"
              "void main() { result = colour(tint, alphas[INDEX]); }\n");
    Result<Program> program = load({{"INDEX", "2"}});
    ASSERT_TRUE(program) << program.error().message;
    program->set("tint.rgb", vec3(1, 2, 3));
    program->set("alphas", std::span<const float>(std::array{0.1F, 0.2F, 0.5F}));
    program->set("unused", 3);  // declared, optimised away: ignored
    EXPECT_EQ(paint(*program), vec4(1, 2, 3, 0.5F));
}

TEST_F(GpuProgram, ACompileErrorNamesTheIncludedFileAndItsLine) {
    writeFile("shaders/wrong.h", "float fine() { return 1.0; }\n\nfloat wrong() { return undefinedName; }\n");
    writeFile("shaders/paint.frag", "out vec4 result;\n#include \"shaders/wrong.h\"\nvoid main() { result = vec4(wrong()); }\n");
    const Result<Program> program = load();
    ASSERT_FALSE(program);
    EXPECT_NE(program.error().message.find("shaders/wrong.h:3"), std::string::npos) << program.error().message;
    EXPECT_NE(program.error().message.find("undefinedName"), std::string::npos) << program.error().message;
    EXPECT_EQ(program.error().fault, Fault::failed);
}

TEST_F(GpuProgram, ALineAfterAnIncludeKeepsItsNumber) {
    writeFile("shaders/fine.h", "float one() {\n return 1.0;\n}\n");
    writeFile("shaders/paint.frag", "out vec4 result;\n#include \"shaders/fine.h\"\n\nvoid main() { result = vec4(two()); }\n");
    const Result<Program> program = load();
    ASSERT_FALSE(program);
    EXPECT_NE(program.error().message.find("shaders/paint.frag:4"), std::string::npos) << program.error().message;
}

TEST_F(GpuProgram, AMissingFileAndALinkErrorAreSentencesToo) {
    const Result<Program> missing = load();
    ASSERT_FALSE(missing);
    EXPECT_NE(missing.error().message.find("shaders/paint.frag"), std::string::npos) << missing.error().message;
    writeFile("shaders/paint.frag", "out vec4 result;\nvec3 elsewhere();\nvoid main() { result = vec4(elsewhere(), 1); }\n");
    const Result<Program> unlinked = load();
    ASSERT_FALSE(unlinked);
    EXPECT_NE(unlinked.error().message.find("shaders/paint.frag"), std::string::npos) << unlinked.error().message;
}

TEST_F(GpuProgram, AFailedReloadKeepsTheLastGoodProgram) {
    writeFile("shaders/paint.frag", "out vec4 result; uniform float v;\nvoid main() { result = vec4(v); }\n");
    Result<Program> program = load();
    ASSERT_TRUE(program) << program.error().message;
    program->set("v", 0.5F);
    const GLuint before = program->name();

    writeFile("shaders/paint.frag", "out vec4 result; uniform float v;\nvoid main() { result = vec4(v) }\n");
    const Status broken = program->reload();
    ASSERT_FALSE(broken);
    EXPECT_NE(broken.error().message.find("shaders/paint.frag:2"), std::string::npos) << broken.error().message;
    EXPECT_EQ(program->name(), before);
    EXPECT_EQ(paint(*program), vec4(0.5F)) << "with its uniforms";

    writeFile("shaders/paint.frag", "out vec4 result; uniform float w;\nvoid main() { result = vec4(w); }\n");
    const Status renamed = program->reload();
    ASSERT_FALSE(renamed) << "a uniform that the program sets is gone";
    EXPECT_NE(renamed.error().message.find("\"v\""), std::string::npos) << renamed.error().message;

    writeFile("shaders/paint.frag", "out vec4 result; uniform float v;\nvoid main() { result = vec4(v + 1.0); }\n");
    ASSERT_TRUE(program->reload());
    glUseProgram(0);  // a program in use outlives its name
    EXPECT_FALSE(glIsProgram(before));
    program->set("v", 0.5F);
    EXPECT_EQ(paint(*program), vec4(1.5F));
}

TEST_F(GpuProgram, ProgramsAreReloadedAllOrNone) {
    writeFile("shaders/value.h", "const float kValue = 1.0;\n");
    writeFile("shaders/paint.frag", "#include \"shaders/value.h\"\nout vec4 result;\nvoid main() { result = vec4(kValue); }\n");
    Result<Program> plain = load(), other = load({{"OTHER", "1"}});
    ASSERT_TRUE(plain && other);
    Program* const both[] = {&*plain, &*other};
    Result<size_t> others = Program::reload(both);
    ASSERT_TRUE(others);
    EXPECT_EQ(*others, 0U) << "nothing was written";
    writeFile("shaders/value.h", "#ifdef OTHER\nconst float kValue = wrong;\n#else\nconst float kValue = 2.0;\n#endif\n");
    EXPECT_FALSE(Program::reload(both));
    EXPECT_EQ(paint(*plain), vec4(1.0F));
    writeFile("shaders/value.h", "const float kValue = 2.0;\n");
    others = Program::reload(both);
    ASSERT_TRUE(others) << others.error().message;
    EXPECT_EQ(*others, 2U);
    EXPECT_EQ(paint(*plain), vec4(2.0F));
    EXPECT_EQ(paint(*other), vec4(2.0F));
}

TEST_F(GpuProgram, SettingAnUndeclaredUniformIsAProgrammingError) {
    writeFile(
        "shaders/paint.frag",
        "out vec4 result; uniform float v; // uniform float onlyInAComment;\nvoid main() { float local = v; result = vec4(local); }\n");
    Result<Program> program = load();
    ASSERT_TRUE(program) << program.error().message;
    EXPECT_DEATH(program->set("local", 1.0F), "\"local\"");
    EXPECT_DEATH(program->set("onlyInAComment", 1.0F), "onlyInAComment");
}

TEST_F(GpuProgram, AComputeProgramCoversAsManyInvocationsAsAskedFor) {
    writeFile("shaders/count.comp",
              "layout(local_size_x = 8, local_size_y = 4) in;\nlayout(binding = 0, r32ui) uniform uimage2D image;\n"
              "void main() { ivec2 at = ivec2(gl_GlobalInvocationID.xy);\n"
              "  if (all(lessThan(at, imageSize(image)))) imageStore(image, at, uvec4(at.x + 100 * at.y)); }\n");
    Result<Program> program = Program::create(ShaderFiles(root()), {"shaders/count.comp"});
    ASSERT_TRUE(program) << program.error().message;
    Result<Texture> texture = Texture::create({.width = 19, .height = 7, .format = Format::r32ui});
    ASSERT_TRUE(texture);
    texture->bindImage(0, GL_WRITE_ONLY);
    program->dispatch(19, 7);
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    std::vector<uint32_t> texels(19 * 7);
    texture->read(std::as_writable_bytes(std::span(texels)));
    for (uint32_t y = 0; y < 7; ++y)
        for (uint32_t x = 0; x < 19; ++x) ASSERT_EQ(texels[19 * y + x], x + 100 * y);
    program->dispatch(0, 7);  // nothing
}

}  // namespace
}  // namespace rivulet::gpu::gpu_program_test
