// Memory that OpenCL shares with OpenGL: refused if the driver has no extension for it or fails the test, and used as documented if it
// does. The sharing driver is simulated: OpenCL memory beside each OpenGL buffer is synchronised when it is acquired and released.
#define CL_TARGET_OPENCL_VERSION 120
#include "engine/compute/cl_sharing.h"

#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>

#include "engine/app/gl_count.h"
#include "engine/core/extension_list.h"
#include "engine/gpu/current_context.h"
#include "engine/gpu/load.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/session/run_stats.h"
#include "tests/parity/devices.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::gl_sharing_test {
namespace {

enum class Lie { none, blind, mute, once, whole, elsewhere, noContext, noWrap, noAcquire, noRelease };

// The state of the simulated driver. It is global, because driver functions take no user data.
struct Played {
    Lie lie = Lie::none;
    std::string extensions = "cl_khr_byte_addressable_store cl_khr_gl_sharing cl_khr_fp64";
    std::map<cl_mem, GLuint> wrapped;
    std::map<cl_mem, int> acquired;  // number of times
    int calls = 0, acquires = 0, releases = 0, live = 0, outlived = 0;
    bool counts = false;                                // OpenGL's commands are counted (countingFind)
    int finishes = 0;                                   // of OpenGL, by GlContext::finish
    size_t finishedAfter = SIZE_MAX;                    // OpenGL's commands up to the last of these, itself included
    int inOrder = 0;                                    // acquires with no command of OpenGL since the last finish
    size_t together = 0;                                // of the last acquire
    int failFrom = 1 << 30;                             // the acquire that fails, and all after it
    std::thread::id home = std::this_thread::get_id();  // where OpenGL is
} played;

size_t bytesOf(GLuint buffer) {
    GLint64 bytes = 0;
    glGetNamedBufferParameteri64v(buffer, GL_BUFFER_SIZE, &bytes);
    return static_cast<size_t>(bytes);
}

std::string extensions(cl_device_id) { return played.extensions; }

cl_device_id driving(cl_platform_id platform, const cl_context_properties* properties) {
    ++played.calls;
    bool asked = false;
    for (const cl_context_properties* p = properties; *p != 0; p += 2)
        asked = asked || (*p == CL_GL_CONTEXT_KHR && reinterpret_cast<void*>(p[1]) == gpu::currentContext().context);
    EXPECT_TRUE(asked) << "the OpenGL context is named";
    cl_device_id first = nullptr;
    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &first, nullptr);
    return played.lie == Lie::elsewhere ? nullptr : first;
}

cl_context createContext(const cl_context_properties* properties, cl_device_id device, cl_int* code) {
    ++played.calls;
    *code = CL_INVALID_GL_SHAREGROUP_REFERENCE_KHR;
    if (played.lie == Lie::noContext) return nullptr;
    const cl_context_properties plain[] = {CL_CONTEXT_PLATFORM, properties[1], 0};
    return clCreateContext(plain, 1, &device, nullptr, nullptr, code);
}

void CL_CALLBACK gone(cl_mem memory, void*) {
    --std::atomic_ref(played.live);
    if (std::this_thread::get_id() == played.home && glIsBuffer(played.wrapped.at(memory)) == GL_FALSE) ++std::atomic_ref(played.outlived);
}

// Buffers that still live, as many as `expected` if they soon are: PoCL frees one when the last command with it has ended, on its own
// thread.
int liveSoon(int expected) {
    std::atomic_ref live(played.live);
    for (int k = 0; k < 2000 && live != expected; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return live;
}

cl_mem CL_API_CALL wrap(cl_context context, cl_mem_flags flags, cl_GLuint buffer, cl_int* code) {
    ++played.calls;
    *code = CL_INVALID_GL_OBJECT;
    if (played.lie == Lie::noWrap) return nullptr;
    EXPECT_TRUE(glIsBuffer(buffer));
    const cl_mem memory = clCreateBuffer(context, flags, bytesOf(buffer), nullptr, code);
    played.wrapped[memory] = buffer;
    played.acquired[memory] = 0;
    ++std::atomic_ref(played.live);
    clSetMemObjectDestructorCallback(memory, gone, nullptr);
    return memory;
}

cl_int CL_API_CALL acquire(cl_command_queue queue, cl_uint count, const cl_mem* all, cl_uint, const cl_event*, cl_event*) {
    ++played.calls;
    if (played.lie == Lie::noAcquire || played.acquires >= played.failFrom) return CL_OUT_OF_RESOURCES;
    ++played.acquires;
    if (played.counts && glCount().all() == played.finishedAfter) ++played.inOrder;
    played.together = count;
    for (cl_uint k = 0; k < count; ++k) {
        const bool brings = played.lie != Lie::blind && (played.lie != Lie::once || played.acquired[all[k]] == 0);
        ++played.acquired[all[k]];
        if (!brings) continue;
        std::vector<std::byte> bytes(bytesOf(played.wrapped.at(all[k])));
        glGetNamedBufferSubData(played.wrapped.at(all[k]), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
        clEnqueueWriteBuffer(queue, all[k], CL_TRUE, 0, bytes.size(), bytes.data(), 0, nullptr, nullptr);
    }
    return CL_SUCCESS;
}

cl_int CL_API_CALL release(cl_command_queue queue, cl_uint count, const cl_mem* all, cl_uint, const cl_event*, cl_event* done) {
    ++played.calls;
    if (played.lie == Lie::noRelease) return CL_INVALID_OPERATION;
    ++played.releases;
    for (cl_uint k = 0; k < count && played.lie != Lie::mute; ++k) {
        std::vector<std::byte> bytes(bytesOf(played.wrapped.at(all[k])));
        clEnqueueReadBuffer(queue, all[k], CL_TRUE, 0, bytes.size(), bytes.data(), 0, nullptr, nullptr);
        if (played.lie == Lie::whole) std::memset(bytes.data(), 0, bytes.size() / 2);
        glNamedBufferSubData(played.wrapped.at(all[k]), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
    }
    return clEnqueueMarkerWithWaitList(queue, 0, nullptr, done);
}

constexpr ClGlCalls kPlayed{extensions, driving, createContext, wrap, acquire, release};

// As the context's own: what the program waits for is what is tested.
void finishAndCount() {
    gpu::currentContext().finish();
    ++played.finishes;
    if (played.counts) played.finishedAfter = glCount().all();
}

// A block of water: `sides` particles along an edge.
SceneFile block(int sides) {
    SceneFile scene;
    scene.name = "block";
    scene.fluid.spacing = 0.05F;
    scene.fluid.box.max = vec3(2.0F);
    scene.fluid.blocks = {{vec3(0.1F), vec3(0.1F + 0.05F * static_cast<float>(sides)), vec3(0.0F)}};
    return scene;
}

class GlSharingTest : public GpuTest {
  protected:
    void SetUp() override {
        if (const Result<TestGpu> gpu = makeTestGpu("cl"); !gpu) GTEST_SKIP() << gpu.error().message;
        GpuTest::SetUp();
        played = {};
    }
    std::unique_ptr<Device> playing(Lie lie = Lie::none) {
        played.lie = lie;
        GlContext gl = gpu::currentContext();
        gl.finish = finishAndCount;
        auto made = makeClDevice(ShaderFiles::developer(), {}, {.gl = gl, .glCalls = &kPlayed});
        EXPECT_TRUE(made);
        return std::move(*made);
    }
    static std::unique_ptr<Session> sessionOn(Device& device, const SceneFile& scene) {
        auto made = Session::create(scene, device, {});
        EXPECT_TRUE(made);
        for (int k = 0; k < 3; ++k) (*made)->step(1.0 / 60, true);
        return std::move(*made);
    }
    template <class T>
    static std::vector<T> inGl(unsigned name, size_t count) {
        std::vector<T> items(count);
        glGetNamedBufferSubData(name, 0, static_cast<GLsizeiptr>(count * sizeof(T)), items.data());
        return items;
    }
    // True if the drawn particles equal those of the world, by id.
    static void expectDrawn(const FluidWorld& world, const FluidView& view) {
        const uint32_t n = world.particles().slots;
        ASSERT_EQ(view.count, n);
        ASSERT_GT(n, 0U);
        const auto sorted = [n](const std::vector<vec4>& values, const std::vector<uint32_t>& id) {
            std::vector<vec4> by(n, vec4(NAN));
            for (uint32_t i = 0; i < n; ++i) by.at(id[i]) = values[i];
            return by;
        };
        const std::vector<uint32_t> id = world.device().readAll<uint32_t>(*world.particles().id, n), drawn = inGl<uint32_t>(view.id, n);
        EXPECT_EQ(sorted(inGl<vec4>(view.position, n), drawn), sorted(world.device().readAll<vec4>(*world.particles().drawn, n), id));
        EXPECT_EQ(sorted(inGl<vec4>(view.velocity, n), drawn), sorted(world.device().readAll<vec4>(*world.particles().velocity, n), id));
    }
};

TEST_F(GlSharingTest, ADriverWithoutTheExtensionIsNotCalledAndTheRingIsUsed) {
    auto made = makeClDevice(ShaderFiles::developer(), {}, {.gl = gpu::currentContext()});
    ASSERT_TRUE(made);
    const GlShare share = (*made)->glShare();
    if (share.by) GTEST_SKIP() << (*made)->info().name << " shares";
    EXPECT_NE(share.whyNot.find("offers no cl_khr_gl_sharing"), std::string::npos) << share.whyNot;
    const auto session = sessionOn(**made, block(8));
    FluidUpload upload;
    const auto view = upload.view(session->world(), session->scene().look);
    ASSERT_TRUE(view);
    expectDrawn(session->world(), *view);
    EXPECT_STREQ(upload.facts().way, "ring");
    EXPECT_EQ(upload.facts().why, share.whyNot);
    EXPECT_GT(upload.facts().bytes, 0U);
    EXPECT_NE(sentenceOf(upload.facts()).find(share.whyNot), std::string::npos);
}

TEST_F(GlSharingTest, WithoutAnOpenGlContextTheDriverIsNotCalled) {
    auto made = makeClDevice(ShaderFiles::developer(), {}, {.glCalls = &kPlayed});
    ASSERT_TRUE(made);
    EXPECT_EQ((*made)->glShare().by, nullptr);
    EXPECT_EQ((*made)->glShare().whyNot, "no OpenGL context is current");
    EXPECT_EQ(played.calls, 0);
}

TEST_F(GlSharingTest, TheCurrentContextIsTheOneThatWasMade) {
    const GlContext gl = gpu::currentContext();
    EXPECT_TRUE(gl.egl);
    EXPECT_NE(gl.context, nullptr);
    EXPECT_NE(gl.display, nullptr);
    void* elsewhere = this;
    std::thread([&] { elsewhere = gpu::currentContext().context; }).join();
    EXPECT_EQ(elsewhere, nullptr) << "none is current on another thread";
}

TEST_F(GlSharingTest, AnExtensionIsAWholeWord) {
    for (const char* words : {"", " ", "cl_khr_gl_sharing_more", "my_cl_khr_gl_sharing", "cl_khr_gl_sharin", "cl_khr_gl",
                              "CL_KHR_GL_SHARING", "cl_khr_gl_sharing_more x_cl_khr_gl_sharing cl_khr_gl_event"}) {
        EXPECT_FALSE(hasExtension(words, "cl_khr_gl_sharing")) << words;
        played = {};
        played.extensions = words;
        EXPECT_EQ(playing()->glShare().by, nullptr) << words;
        EXPECT_EQ(played.calls, 0) << words;
    }
    for (const char* words : {"cl_khr_gl_sharing", "a cl_khr_gl_sharing", "cl_khr_gl_sharing ", "cl_khr_gl_sharing_more cl_khr_gl_sharing"})
        EXPECT_TRUE(hasExtension(words, "cl_khr_gl_sharing")) << words;
}

TEST_F(GlSharingTest, SharingIsRefusedIfTheDriverFailsItsTest) {
    const struct {
        Lie lie;
        const char* said;
    } all[] = {{Lie::blind, "OpenCL does not read what OpenGL wrote"},
               {Lie::once, "OpenCL does not read what OpenGL wrote"},
               {Lie::mute, "OpenGL does not read what OpenCL wrote"},
               {Lie::whole, "OpenGL does not read what OpenCL wrote"},
               {Lie::elsewhere, "does not drive the OpenGL context"},
               {Lie::noContext, "CL_INVALID_GL_SHAREGROUP_REFERENCE_KHR"},
               {Lie::noWrap, "CL_INVALID_GL_OBJECT"},
               {Lie::noAcquire, "CL_OUT_OF_RESOURCES"},
               {Lie::noRelease, "CL_INVALID_OPERATION"}};
    for (const auto& row : all) {
        SCOPED_TRACE(row.said);
        played = {};
        const std::unique_ptr<Device> device = playing(row.lie);
        EXPECT_EQ(device->glShare().by, nullptr);
        EXPECT_NE(device->glShare().whyNot.find(row.said), std::string::npos) << device->glShare().whyNot;
        EXPECT_EQ(liveSoon(0), 0);
        EXPECT_EQ(played.outlived, 0);
        for (const auto& [memory, name] : played.wrapped) EXPECT_FALSE(glIsBuffer(name)) << "the trial's buffer is gone";
        const auto session = sessionOn(*device, block(6));  // it works without sharing
        EXPECT_EQ(session->world().stats().nan, 0U);
        FluidUpload upload;
        const auto view = upload.view(session->world(), session->scene().look);
        ASSERT_TRUE(view);
        expectDrawn(session->world(), *view);
        EXPECT_STREQ(upload.facts().way, "ring");
        EXPECT_EQ(device->health().state, DeviceHealth::works);
    }
}

TEST_F(GlSharingTest, SharedBuffersHoldTheWorldAndAreAcquiredAndReleasedOnceAFrame) {
    const std::unique_ptr<Device> device = playing();
    ASSERT_NE(device->glShare().by, nullptr) << device->glShare().whyNot;
    const auto session = sessionOn(*device, block(8));
    FluidUpload upload;
    for (int frame = 0; frame < 3; ++frame) {
        session->step(1.0 / 60, true);
        const int acquires = played.acquires, releases = played.releases;
        const auto view = upload.view(session->world(), session->scene().look);
        ASSERT_TRUE(view);
        EXPECT_EQ(played.acquires, acquires + 1);
        EXPECT_EQ(played.releases, releases + 1);
        EXPECT_GE(played.together, 3U) << "positions, velocities and ids at least";
        expectDrawn(session->world(), *view);
        EXPECT_EQ(inGl<vec4>(view->position, view->count), device->readAll<vec4>(*session->world().particles().drawn, view->count))
            << "in the world's own order";
        EXPECT_EQ(view->half, 0U) << "which is no order to draw half of them in";
        EXPECT_STREQ(upload.facts().way, "shared with OpenCL");
        EXPECT_EQ(upload.facts().why, "");
        EXPECT_EQ(upload.facts().bytes, 0U);
        EXPECT_EQ(sentenceOf(upload.facts()).rfind("shared with OpenCL: ", 0), 0U) << sentenceOf(upload.facts());
        EXPECT_EQ(liveSoon(static_cast<int>(played.together)), static_cast<int>(played.together)) << "wrapped once, however many frames";
    }
}

// The simulated driver reads OpenGL's buffers by a call that waits by itself; drivers of GPUs do not. Without cl_khr_gl_event, an acquire
// must come after a glFinish that no command of OpenGL follows; with it, nothing waits.
TEST_F(GlSharingTest, OpenGlIsFinishedBeforeEachAcquireUnlessTheDriverOrdersTheCommands) {
    for (const bool ordered : {false, true}) {
        SCOPED_TRACE(ordered ? "cl_khr_gl_event" : "no cl_khr_gl_event");
        played = {};
        if (ordered) played.extensions += " cl_khr_gl_event";
        ASSERT_TRUE(gpu::load(countingFind));
        startGlCount();
        played.counts = true;
        const std::unique_ptr<Device> device = playing();
        ASSERT_NE(device->glShare().by, nullptr) << device->glShare().whyNot;
        const auto session = sessionOn(*device, block(8));
        FluidUpload upload;
        for (int frame = 0; frame < 3; ++frame) {
            session->step(1.0 / 60, true);
            const auto view = upload.view(session->world(), session->scene().look);
            ASSERT_TRUE(view);
            EXPECT_STREQ(upload.facts().way, "shared with OpenCL");
            expectDrawn(session->world(), *view);  // commands of OpenGL, which the next frame must finish
        }
        EXPECT_GE(played.acquires, 5) << "two of the test at start, and one a frame";
        EXPECT_EQ(played.inOrder, ordered ? 0 : played.acquires);
        EXPECT_EQ(played.finishes, ordered ? 0 : played.acquires);
        const GlCalls calls = glCount();
        const auto finished = calls.byName.find("glFinish");
        EXPECT_EQ(finished == calls.byName.end() ? 0U : finished->second, static_cast<size_t>(played.finishes));
    }
}

TEST_F(GlSharingTest, AGrownBufferIsWrappedAgainAfterTheOldOneIsReleased) {
    const std::unique_ptr<Device> device = playing();
    FluidUpload upload;
    for (const int sides : {4, 9, 6, 12}) {
        const auto session = sessionOn(*device, block(sides));
        const auto view = upload.view(session->world(), session->scene().look);
        ASSERT_TRUE(view);
        expectDrawn(session->world(), *view);
        EXPECT_STREQ(upload.facts().way, "shared with OpenCL");
        EXPECT_EQ(liveSoon(static_cast<int>(played.together)), static_cast<int>(played.together)) << sides;
        EXPECT_EQ(played.outlived, 0) << sides;
    }
}

TEST_F(GlSharingTest, AfterAFailureDuringARunTheRingIsUsed) {
    const std::unique_ptr<Device> device = playing();
    const auto session = sessionOn(*device, block(8));
    FluidUpload upload;
    ASSERT_TRUE(upload.view(session->world(), session->scene().look));
    EXPECT_STREQ(upload.facts().way, "shared with OpenCL");
    played.failFrom = played.acquires;
    for (int frame = 0; frame < 2; ++frame) {
        session->step(1.0 / 60, true);
        const auto view = upload.view(session->world(), session->scene().look);
        ASSERT_TRUE(view);
        expectDrawn(session->world(), *view);
        EXPECT_STREQ(upload.facts().way, "ring");
        EXPECT_EQ(upload.facts().why, "OpenCL could not acquire OpenGL's buffers: CL_OUT_OF_RESOURCES");
        EXPECT_EQ(liveSoon(0), 0);
        EXPECT_EQ(played.outlived, 0);
        played.failFrom = 1 << 30;  // it would work again, but is not tried
    }
    EXPECT_EQ(device->health().state, DeviceHealth::works);
}

TEST_F(GlSharingTest, WhenTheCpuTakesOverNothingIsLeftWrapped) {
    const std::unique_ptr<Device> cpu = makeTestCpu();  // outlives the session
    std::unique_ptr<Device> device = playing();
    const auto session = sessionOn(*device, block(8));
    FluidUpload upload;
    ASSERT_TRUE(upload.view(session->world(), session->scene().look));
    EXPECT_GT(played.live, 0);
    ASSERT_TRUE(session->moveTo(*cpu));
    device.reset();
    session->step(1.0 / 60, true);
    const auto view = upload.view(session->world(), session->scene().look);
    ASSERT_TRUE(view);
    expectDrawn(session->world(), *view);
    EXPECT_STREQ(upload.facts().way, "ring");
    EXPECT_NE(upload.facts().why, "");
    EXPECT_EQ(liveSoon(0), 0);
    EXPECT_EQ(played.outlived, 0);
}

// A device may be destroyed before its renderer, as in a run without a window, or after it, as in the window.
TEST_F(GlSharingTest, NothingLeaksInEitherOrderOfDestruction) {
    for (const bool deviceFirst : {true, false}) {
        SCOPED_TRACE(deviceFirst);
        played = {};
        std::unique_ptr<Device> device = playing();
        auto session = sessionOn(*device, block(8));
        auto upload = std::make_unique<FluidUpload>();
        ASSERT_TRUE(upload->view(session->world(), session->scene().look));
        EXPECT_GT(played.live, 0);
        session.reset();
        if (deviceFirst) device.reset();
        upload.reset();
        EXPECT_EQ(liveSoon(0), 0);
        EXPECT_EQ(played.outlived, 0);
        device.reset();
    }
}

// A new device at the same address: no data of the old device is used.
TEST_F(GlSharingTest, AnotherDeviceIsNotTakenForTheLastOne) {
    FluidUpload upload;
    for (int k = 0; k < 3; ++k) {
        const std::unique_ptr<Device> device = playing();
        const auto session = sessionOn(*device, block(7));
        const auto view = upload.view(session->world(), session->scene().look);
        ASSERT_TRUE(view);
        expectDrawn(session->world(), *view);
        EXPECT_STREQ(upload.facts().way, "shared with OpenCL");
        EXPECT_EQ(liveSoon(static_cast<int>(played.together)), static_cast<int>(played.together));
        EXPECT_EQ(played.outlived, 0);
    }
}

// The driver's own functions: of a GPU, or of tests/sharing, which poisons what the other side owns and ends the process at a wrong use.
TEST_F(GlSharingTest, ADriverThatSharesIsUsedFromTheFirstFrameToTheLast) {
    auto made = makeClDevice(ShaderFiles::developer(), {}, {.gl = gpu::currentContext()});
    ASSERT_TRUE(made);
    std::unique_ptr<Device> device = std::move(*made);
    if (!device->glShare().by) {
        ASSERT_EQ(std::getenv("RIVULET_SHARING"), nullptr) << device->glShare().whyNot;
        GTEST_SKIP() << device->glShare().whyNot;
    }
    FluidUpload upload;
    std::unique_ptr<Session> session;
    for (const int sides : {4, 9, 6}) {  // buffers grow and are wrapped anew
        session = sessionOn(*device, block(sides));
        for (int frame = 0; frame < 4; ++frame) {
            session->step(1.0 / 60, true);
            const auto view = upload.view(session->world(), session->scene().look);
            ASSERT_TRUE(view);
            expectDrawn(session->world(), *view);
            EXPECT_STREQ(upload.facts().way, "shared with OpenCL") << upload.facts().why;
        }
    }
    session.reset();
    device.reset();  // before the buffers that were wrapped
}

}  // namespace
}  // namespace rivulet::gl_sharing_test
