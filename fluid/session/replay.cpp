#include "fluid/session/replay.h"

#include <fmt/format.h>

#include "fluid/render/fluid_upload.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

std::string_view takeLine(std::string_view& text) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line.empty() ? std::string_view("nothing else") : line;
}

// Error (badInput): names the first line that differs.
Status sameScene(const std::string& path, std::string_view recorded, std::string_view now) {
    while (!recorded.empty() || !now.empty()) {
        const std::string_view was = takeLine(recorded), is = takeLine(now);
        if (was != is)
            return badInput(
                fmt::format("{}: it was recorded with {}, this scene has {}: use the scene, the --preset and the --set of the "
                            "recording",
                            path, was, is));
    }
    return ok();
}

// Those of `items` that `kept` names.
template <class T>
std::vector<T> chosen(const std::vector<T>& items, const std::vector<uint32_t>& kept) {
    std::vector<T> out;
    out.reserve(kept.size());
    for (const uint32_t i : kept) out.push_back(items[i]);
    return out;
}

}  // namespace

std::string aboutOf(const SceneFile& scene) {
    SceneFile copy = scene;
    const std::string all = fixedValues([&copy](ParamVisitor& v) { copy.visit(v); });
    std::string about = fmt::format("name = {}\n", scene.name);
    for (std::string_view rest = all; !rest.empty();) {
        const std::string_view line = takeLine(rest);
        if (line.starts_with("colliders") || line.starts_with("bodies")) about += fmt::format("{}\n", line);
    }
    return about;
}

RecordedFrame frameOf(const Session& session) {
    const FluidWorld& world = session.world();
    Device& device = world.device();
    const ParticleView particles = world.particles();
    RecordedFrame frame;
    frame.time = world.time();
    frame.spacing = particles.spacing;
    frame.halves = device.backend() != Backend::gl && !device.glShare().by;  // as FluidUpload brings them over
    frame.box.add(world.params().box.min);
    frame.box.add(world.params().box.max);
    if (particles.count > 0) {
        // Free slots and samples on bodies are not drawn.
        const std::vector<vec4> position = device.readAll<vec4>(*particles.drawn, particles.slots);
        std::vector<uint32_t> kept;
        for (uint32_t i = 0; i < position.size(); ++i)
            if (!(position[i].w < 0)) kept.push_back(i);
        const auto read = [&](const Buffer* from) {
            return from == nullptr ? std::vector<vec4>() : chosen(device.readAll<vec4>(*from, particles.slots), kept);
        };
        frame.position = chosen(position, kept);
        frame.velocity = read(particles.velocity);
        frame.id = chosen(device.readAll<uint32_t>(*particles.id, particles.slots), kept);
        frame.normal = read(particles.normal);
        frame.absorption = read(particles.absorption);
        for (size_t k = 0; k < frame.ellipsoids.size(); ++k) frame.ellipsoids[k] = read(particles.ellipsoids[k]);
    }
    if (particles.foam != nullptr && particles.foamSlots > 0) {
        const std::vector<vec4> foam = device.readAll<vec4>(*particles.foamDrawn, particles.foamSlots);
        std::vector<uint32_t> kept;
        for (uint32_t i = 0; i < foam.size(); ++i)
            if (foam[i].w > 0) kept.push_back(i);
        frame.foam = chosen(foam, kept);
        frame.foamVelocity = chosen(device.readAll<vec4>(*particles.foamVelocity, particles.foamSlots), kept);
    }
    session.placesInto(frame);
    return frame;
}

Result<FluidView> viewOf(FluidUpload& upload, const Session& session) {
    if (session.replaying() != nullptr) {
        Result<FluidView> shown = upload.view(session.replaying()->shown(), session.scene().look);
        if (!shown) return shown;
        shown->viscosity = session.world().particles().viscosity;  // the world's start has the liquids of the scene
        return shown;
    }
    return upload.view(session.world(), session.scene().look, session.flows().airDrops(), session.flows().pendants());
}

Result<Replay> Replay::open(const std::string& path, const SceneFile& scene, const Log& log) {
    Result<RecordingReader> reader = RecordingReader::open(path);
    if (!reader) return reader.error();
    if (Status same = sameScene(path, reader->about(), aboutOf(scene)); !same) return same.error();
    if (!reader->cut().empty()) log.notice(reader->cut());
    Replay replay(std::move(*reader), path);
    if (Status first = replay.next(); !first) return first.error();
    replay.seek(0);
    return replay;
}

Status Replay::next() {
    status_ = ok();
    if (next_ >= reader_.frames()) return status_;
    Result<RecordedFrame> frame = reader_.read(next_);
    if (!frame) return status_ = frame.error();
    frame_ = std::move(*frame);
    at_ = next_++;
    return status_;
}

std::string Replay::sentence() const {
    return fmt::format("frame {} of {} of {}: {:.2f} s, {} particles", at_ + 1, frames(), path_, frame_.time, frame_.position.size());
}

}  // namespace rivulet
