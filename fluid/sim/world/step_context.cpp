#include "fluid/sim/world/step_context.h"

#include <algorithm>

namespace rivulet {

Result<PairKernel> PairKernel::find(Device& device, std::string_view path, const PairTraits& traits, std::span<const Define> extra) {
    std::vector<Define> defines = traits.defines();
    defines.insert(defines.end(), extra.begin(), extra.end());
    std::sort(defines.begin(), defines.end(), [](const Define& a, const Define& b) { return a.name < b.name; });
    Result<Kernel> found = device.kernel(path, defines);
    if (!found) return found.error();
    return PairKernel{*found, traits.matter};
}

void PairKernel::run(StepContext& c, const StepParams& params, std::initializer_list<const Buffer*> buffers, uint32_t threads) const {
    ++c.solve.sweeps;
    run(c.device, c.particles, params, buffers, threads);
}

void PairKernel::run(Device& device, const Particles& particles, const StepParams& params, std::initializer_list<const Buffer*> buffers,
                     uint32_t threads) const {
    std::vector<const Buffer*> all(buffers);
    if (matter) all.push_back(&particles.matter);
    device.dispatch(kernel, std::as_bytes(std::span(&params, 1)), all, threads);
}

}  // namespace rivulet
