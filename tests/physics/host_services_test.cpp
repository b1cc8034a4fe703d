// A host's job system and memory: the same water, and every block given back.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>

#include "fluid/sim/world/host_particles.h"
#include "tests/physics/worlds.h"

namespace rivulet::host_services_test {
namespace {

// Calls in the reverse order, each on a thread of its own.
void onThreads(void* count, void (*function)(void*, size_t), void* argument, size_t calls) {
    ++*static_cast<int*>(count);
    std::vector<std::thread> threads;
    for (size_t k = calls; k-- > 0;) threads.emplace_back(function, argument, k);
    for (std::thread& t : threads) t.join();
}

FluidParams dam(const std::string& method) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.025F;
    p.box.max = vec3(0.8F, 0.5F, 0.4F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.3F, 0.4F, 0.4F)}};
    return p;
}

std::vector<vec4> after(CpuDevice& device, const FluidParams& p, int frames) {
    auto world = makeWorld(device, p);
    for (int frame = 0; frame < frames; ++frame) world->step({}, 1.0 / 60);
    return readParticles(*world).position;
}

TEST(HostJobs, GiveTheSameWater) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    for (const char* method : {"pbf", "dfsph"}) {
        int loops = 0;
        auto own = makeCpuDevice(rows), one = makeCpuDevice(rows, {.threads = 1});
        auto host = makeCpuDevice(rows, {.jobs = {&loops, onThreads, 3}});
        EXPECT_EQ(host->threads(), 3);
        const std::vector<vec4> expected = after(*one, dam(method), 5);
        EXPECT_EQ(after(*own, dam(method), 5), expected);
        EXPECT_EQ(after(*host, dam(method), 5), expected);
        EXPECT_GT(loops, 100);
    }
}

TEST(HostJobs, AreLimitedByThreads) {
    int loops = 0;
    auto device = makeCpuDevice({}, {.threads = 1, .jobs = {&loops, onThreads, 3}});
    EXPECT_EQ(device->threads(), 1);
    device->parallelFor(1000, 10, [](size_t, size_t) {});
    EXPECT_EQ(loops, 0);
}

struct Heap {
    std::map<void*, size_t> blocks;
    size_t total = 0, limit = SIZE_MAX;

    static void* allocate(void* self, size_t bytes, size_t alignment) {
        auto& heap = *static_cast<Heap*>(self);
        EXPECT_EQ(bytes % alignment, 0U);
        if (heap.total + bytes > heap.limit) return nullptr;
        void* block = std::aligned_alloc(alignment, bytes);
        std::memset(block, 0xA5, bytes);
        heap.total += bytes;
        heap.blocks[block] = bytes;
        return block;
    }
    static void release(void* self, void* memory, size_t bytes) {
        auto& heap = *static_cast<Heap*>(self);
        ASSERT_TRUE(heap.blocks.contains(memory));
        EXPECT_EQ(heap.blocks[memory], bytes);
        heap.blocks.erase(memory);
        heap.total -= bytes;
        std::free(memory);
    }
    HostMemory memory() { return {this, allocate, release}; }
};

TEST(HostMemory, HoldsTheBuffersAndGetsAllOfThemBack) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    Heap heap;
    {
        auto device = makeCpuDevice(rows, {.memory = heap.memory()}), plain = makeCpuDevice(rows);
        device->keepReleased();
        EXPECT_EQ(after(*device, dam("dfsph"), 3), after(*plain, dam("dfsph"), 3)) << "memory that is not zero at first";
        auto world = makeWorld(*device, dam("dfsph"));
        EXPECT_GE(heap.total, device->bytesAllocated());
        EXPECT_GT(device->bytesAllocated(), size_t{world->particles().slots} * 100);
    }
    EXPECT_EQ(heap.blocks.size(), 0U);
}

TEST(HostMemory, ARefusalIsAnError) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    Heap heap;
    heap.limit = 100'000;
    auto device = makeCpuDevice(rows, {.memory = heap.memory()});
    const auto world = FluidWorld::create(*device, dam("pbf"), {}, {});
    ASSERT_FALSE(world);
    EXPECT_TRUE(world.error().memory) << world.error().message;
    EXPECT_EQ(heap.total, 0U);
}

}  // namespace
}  // namespace rivulet::host_services_test
