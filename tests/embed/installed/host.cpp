// A second of water in a host's own program. Exit 0: it fell, and none of it was lost. The host has names of its own that are ours, too: a
// header, a function, a macro.
#include <cstdio>

#include "engine/core/log.h"
#define EXACT "the host's macro"
#include "rivulet/engine/compute/device_cpu.h"
#include "rivulet/fluid/sim/world/cpu_kernels.h"
#include "rivulet/fluid/sim/world/fluid_world.h"

using namespace rivulet;

int PASS(int value) { return value; }
const char* const kNames[] = {HOST_LOG, EXACT};

int main() {
    std::vector<CpuKernelRow> rows = cpuKernels();
    std::unique_ptr<Device> device = makeCpuDevice(rows);
    FluidParams params;
    params.spacing = 0.05F;
    params.blocks.resize(1);
    params.blocks[0].min = vec3(0.2F);
    params.blocks[0].max = vec3(0.6F);
    auto world = FluidWorld::create(*device, params, {}, stderrLog());
    if (!world) {
        std::fprintf(stderr, "%s\n", world.error().message.c_str());
        return 1;
    }
    for (int frame = 0; frame < 60; ++frame) (*world)->step({}, 1.0 / 60);
    ParticleView water = (*world)->particles();
    std::vector<vec4> positions = device->readAll<vec4>(*water.position, water.count);
    double height = 0;
    for (const vec4& p : positions) height += static_cast<double>(p.y) / water.count;
    std::printf("%u particles, mean height %.3f m\n", water.count, height);
    return PASS(0) == 0 && kNames[1][0] == 't' && water.count == 512 && height > 0.01 && height < 0.2 && (*world)->stats().lost == 0 ? 0
                                                                                                                                     : 1;
}
