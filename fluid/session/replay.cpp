#include "fluid/session/replay.h"

#include <fmt/format.h>

#include "engine/core/json.h"
#include "fluid/io/world_frame.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet {

namespace {

std::string_view takeLine(std::string_view& text) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line.empty() ? std::string_view("nothing else") : line;
}

// Error (badInput): names the first line that differs. Of a parameter that a later version added there is none in the recording.
Status sameScene(const std::string& path, std::string_view recorded, std::string_view now) {
    if (sameFixedValues(recorded, now)) return ok();
    const std::string all = fmt::format("\n{}", recorded);
    while (!recorded.empty() || !now.empty()) {
        const std::string_view is = takeLine(now);
        if (all.find(fmt::format("\n{}", is.substr(0, is.find(" = ") + 3))) == std::string::npos && !now.empty()) continue;
        const std::string_view was = takeLine(recorded);
        if (was != is)
            return badInput(
                fmt::format("{}: it was recorded with {}, this scene has {}: use the scene, the --preset and the --set of the "
                            "recording",
                            path, was, is));
    }
    return ok();
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

std::string recordedText(const Session& session) {
    SceneFile scene = session.scene(), none;
    const VisitFn defaults = [&none](ParamVisitor& v) { none.visit(v); };
    const Device& device = session.world().device();
    return aboutOf(scene) + textOf({.version = RIVULET_VERSION,
                                    .device = fmt::format("{}: {}", backendName(device.backend()), device.info().name),
                                    .scene = writeJson([&scene](ParamVisitor& v) { scene.visit(v); }, &defaults)});
}

RecordedFrame frameOf(const Session& session) {
    RecordedFrame frame;
    frameOf(session.world(), frame);
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
    const std::string_view recorded = std::string_view(reader->about()).substr(0, endOfAbout(reader->about()));
    if (Status same = sameScene(path, recorded, aboutOf(scene)); !same) return same.error();
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
