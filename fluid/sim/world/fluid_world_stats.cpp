// The figures of a world: sums over its particles, and the ledger of its water.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/fluid_world_impl.h"
#include "shaders/fluid/world/stats_row.h"

namespace rivulet {

void FluidWorld::Impl::fillLedger(FluidStats& f) const {
    const double volume = std::pow(double{params.spacing}, 3);
    f.emitted = (static_cast<double>(startCount) + static_cast<double>(before.emitted + sources.emitted())) * volume;
    f.drained = static_cast<double>(before.drained + sources.drained() + dry.removed()) * volume;
    f.backlog = sources.backlog() * volume;
    f.deposited = static_cast<double>(sources.deposited()) * volume;
    f.pendingVolume = sources.pending() * volume;
    f.withdrawn = static_cast<double>(*withdrawn) * volume;
}

void FluidWorld::Impl::gatherStats(int substeps, double until) {
    std::vector<const Buffer*> buffers = {&grid->cellStart(), &particles.positionNext, &particles.velocityNext, &statsRows};
    if (traits.matter) buffers.insert(buffers.end(), {&particles.id, &particles.matterOf});
    device->dispatch(stats, std::as_bytes(std::span(&step, 1)), buffers, STATS_THREADS);
    if (device->interrupted()) return;
    if (around) around->measure(*device, step, *grid, particles);
    const FluidStats now{.frame = clock.frame,
                         .time = until,
                         .particles = particles.count,
                         .substeps = substeps,
                         .iterations = iterations / substeps,
                         .sweeps = solve.sweeps,
                         .stepped = stepped,
                         .residual = solve.residual,
                         .dtMin = clock.dtMin,
                         .dtMax = clock.dtMax,
                         .bodyWaits = bodies.waits(),
                         .bodyStrays = bodies.strays(),
                         .limited = {}};
    device->readLater(
        statsRows, STATS_THREADS * sizeof(StatsRow),
        [now, weak = std::weak_ptr(figures), mass = double{step.mass}, g = gravity, maxSpeed = step.maxSpeed,
         spacingAStep = params.spacing / step.dt, this](std::span<const std::byte> bytes) {
            const std::shared_ptr<FluidStats> into = weak.lock();
            if (!into) return;  // the world was reset meanwhile, or destroyed
            const StatsRow* rows = reinterpret_cast<const StatsRow*>(bytes.data());
            FluidStats f = now;
            double centre[3] = {0, 0, 0}, inside = 0, masses = 0, compression = 0, speed2 = 0, limited = 0, nan = 0, lost = 0, fastest2 = 0,
                   asleep = 0;
            for (uint32_t k = 0; k < STATS_THREADS; ++k) {
                for (int axis = 0; axis < 3; ++axis) centre[axis] += double{rows[k].centre[axis]};
                masses += double{rows[k].centre.w};
                inside += double{rows[k].inside};
                compression += double{rows[k].compression};
                speed2 += double{rows[k].speed2Sum};
                limited += double{rows[k].limited};
                asleep += double{rows[k].asleep};
                nan += double{rows[k].nans};
                lost += double{rows[k].lost};
                f.maxCompression = std::max(f.maxCompression, double{rows[k].worst});
                fastest2 = std::max(fastest2, double{rows[k].speed2Max});
            }
            f.particles = static_cast<uint32_t>(inside + lost);
            f.lost = static_cast<uint32_t>(lost);
            f.asleep = static_cast<uint32_t>(asleep);
            f.nan = static_cast<uint32_t>(nan);
            f.speedLimited = static_cast<uint32_t>(limited);
            f.maxSpeed = std::sqrt(fastest2);
            f.kinetic = 0.5 * mass * speed2;
            if (inside > 0) {
                f.avgCompression = compression / inside;
                for (int axis = 0; axis < 3; ++axis) {
                    f.centreOfMass[axis] = centre[axis] / masses;
                    f.potential -= mass * double{g[axis]} * centre[axis];
                }
            }
            f.limited = std::move(into->limited);
            f.loads = std::move(into->loads);
            fillLedger(f);
            *into = std::move(f);
            if (sources.full())
                report(fmt::format("the limit of {} particles is reached: emitters wait for free slots; fluid.maxParticles sets the limit",
                                   slots));
            if (into->lost > 0) report("particles left the grid or became NaN: they are frozen and counted as lost");
            if (into->speedLimited == 0) return;
            if (maxSpeed < 0.999F * spacingAStep)
                report(fmt::format("the fastest particles were slowed to {:.3g} m/s: no speed in this scene should be higher", maxSpeed));
            else
                report("the fastest particles were slowed to one spacing a step");
        });
}

}  // namespace rivulet
