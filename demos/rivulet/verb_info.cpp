#include <fmt/format.h>

#include "demos/rivulet/cli.h"
#include "engine/app/context_egl.h"
#include "engine/compute/device_cl.h"
#include "fluid/render/backend.h"
#include "fluid/session/run_stats.h"

namespace rivulet {

int infoVerb(const Arguments& arguments) {
    ArgumentReader reader("info", "Shows the CPU, OpenGL and OpenCL of this machine, and which backend --backend auto selects and why.");
    if (std::optional<int> code = reader.read(arguments)) return *code;

    Result<ContextEgl> context = ContextEgl::create();
    GlFacts gl = context ? currentGlFacts() : noGl(context.error().message);
    std::unique_ptr<Device> cpu = makeDevice("cpu", gl, {});
    const std::vector<ClDeviceListing> cl = listClDevices();

    fmt::print("rivulet  {}\n", RIVULET_VERSION);
    fmt::print("machine  {}\n", machineName());
    fmt::print("CPU      {}\n", cpu->info().name);
    if (gl.present()) {
        fmt::print("OpenGL   {}, {} (by EGL, {})\n", gl.renderer, gl.version, context->platform());
        fmt::print("         {}\n", gl.software ? "a software renderer, which runs on the CPU" : "a GPU");
    } else {
        fmt::print("OpenGL   none: {}\n", gl.absent);
    }
    if (cl.empty()) fmt::print("OpenCL   none\n");
    for (size_t i = 0; i < cl.size(); ++i) fmt::print("{}{} {}\n", i == 0 ? "OpenCL   " : "         ", i + 1, cl[i].sentence);
    BackendChoice choice = chooseBackend("auto", gl);
    fmt::print("auto     selects {}, because {}\n", backendName(choice.backend), choice.why);
    return kDone;
}

}  // namespace rivulet
