// A flow's state, saved in host memory and restored on any device.
#include "engine/core/assert.h"
#include "fluid/flow/surface_flow_impl.h"

namespace rivulet {

struct SurfaceFlow::Snapshot {
    FlowCourse course;
    Impl::Reports reports;
    std::vector<std::vector<uint32_t>> buffers;  // in the order of Impl::remembered()
    // As last sorted. Cells of another device's grid may have another size: drops are sorted again there.
    std::vector<uint32_t> id;
    std::vector<vec4> position, velocity;
};

std::shared_ptr<const SurfaceFlow::Snapshot> SurfaceFlow::save() const {
    Impl& w = *impl_;
    w.device->finish();
    w.device->poll();
    auto made = std::make_shared<Snapshot>();
    made->course = w;
    made->reports = *w.reports;
    for (const Buffer* b : w.remembered()) made->buffers.push_back(w.device->readAll<uint32_t>(*b, b->bytes() / sizeof(uint32_t)));
    made->id = w.device->readAll<uint32_t>(w.drops.id, w.count());
    made->position = w.device->readAll<vec4>(w.drops.position, w.count());
    made->velocity = w.device->readAll<vec4>(w.drops.velocity, w.count());
    return made;
}

Status SurfaceFlow::restore(const Snapshot& snapshot) {
    Impl& w = *impl_;
    ASSERT(snapshot.id.size() == w.count(), "a snapshot of a flow that was made with the same params");
    static_cast<FlowCourse&>(w) = snapshot.course;
    w.reports = std::make_shared<Impl::Reports>(snapshot.reports);
    size_t k = 0;
    for (Buffer* b : w.remembered()) {
        ASSERT(snapshot.buffers[k].size() * sizeof(uint32_t) == b->bytes(), "a snapshot of a flow on the same mesh");
        w.device->writeAll<uint32_t>(*b, snapshot.buffers[k++]);
    }
    w.device->writeAll<uint32_t>(w.drops.id, snapshot.id);
    w.device->writeAll<vec4>(w.drops.positionNext, snapshot.position);
    w.device->writeAll<vec4>(w.drops.velocityNext, snapshot.velocity);
    StepParams s{};
    s.count = s.firstSample = w.count();
    w.grid->fill(s);
    s.h = 1 / s.gridScale.x;
    s.invH = s.gridScale.x;
    // Drawing before the next step shows the skin as it was.
    FlowStep f{};
    f.triangles = static_cast<uint32_t>(w.mesh.triangleCount());
    w.device->run(w.basis, f, {&w.skin, &w.point, &w.frames}, f.triangles);
    w.moved = w.moved || w.thesis.has_value();  // its field is made with the next basis
    return w.grid->build(s, w.drops);
}

}  // namespace rivulet
