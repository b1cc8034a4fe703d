// Makes one video of the images of pieces. The video is bit for bit the one that a single run writes.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/sweep_folder.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/folder.h"
#include "engine/core/message_line.h"
#include "engine/scene/load_image.h"
#include "fluid/scene/scene_file.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

struct FrameName {
    std::string prefix;  // "dam_break"
    int number = 0;
};

// The parts of "dam_break_0042.png"; empty: another name.
std::optional<FrameName> frameNameOf(const std::filesystem::path& path) {
    const std::string stem = path.stem().string();
    const size_t line = stem.rfind('_');
    if (path.extension() != ".png" || line == std::string::npos || stem.size() - line - 1 < 4 || stem.size() - line - 1 > 8) return {};
    FrameName name{stem.substr(0, line), 0};
    for (const char c : stem.substr(line + 1)) {
        if (c < '0' || c > '9') return {};
        name.number = 10 * name.number + (c - '0');
    }
    return name;
}

struct FrameImages {
    std::string prefix;                // of all names
    std::map<int, std::string> files;  // by frame
};

// Adds the images of a folder. Error (badInput): a frame has two images, or the names begin differently: images of different scenes.
Status addImages(const std::filesystem::path& folder, FrameImages& images) {
    for (const std::filesystem::path& path : entriesOf(folder)) {
        const std::optional<FrameName> name = frameNameOf(path);
        if (!name) continue;
        if (images.files.empty()) images.prefix = name->prefix;
        if (name->prefix != images.prefix)
            return badInput(fmt::format("{} and {} are images of different scenes; join those of each scene separately",
                                        images.files.begin()->second, path.string()));
        const auto [at, added] = images.files.emplace(name->number, path.string());
        if (!added)
            return badInput(
                fmt::format("{} and {} are both frame {}; leave one of the folders out", at->second, path.string(), name->number));
    }
    return ok();
}

// Error (badInput): `folder` is that of a sweep, and a task has not ended, so that the video would lack its frames.
Status checkEnded(const std::string& folder) {
    const std::string name = folder + "/sweep.json";
    std::error_code error;
    if (!std::filesystem::exists(name, error)) return ok();
    const Result<std::string> text = readFile(name);
    if (!text) return text.error();
    const Result<Sweep> sweep = readSweep(*text, name);
    if (!sweep) return sweep.error();
    const SweepFolder tasks(folder);
    for (size_t task = 0; task < sweep->tasks; ++task)
        if (!tasks.hasEnded(task))
            return badInput(
                fmt::format("task {} of {} in {} has not ended; run the sweep again until all have", task, sweep->tasks, folder));
    return ok();
}

// The images of all folders; the folder of a sweep stands for those of its tasks. Error (badInput): no folder, no image, a missing frame.
Result<std::map<int, std::string>> imagesOf(const std::vector<std::string>& folders) {
    FrameImages images;
    for (const std::string& folder : folders) {
        std::error_code error;
        if (!std::filesystem::is_directory(folder, error))
            return badInput(fmt::format("{} is no folder; name the folders of the images", folder));
        if (Status ended = checkEnded(folder); !ended) return ended.error();
        if (Status added = addImages(folder, images); !added) return added.error();
        for (const std::filesystem::path& task : entriesOf(std::filesystem::path(folder) / "tasks"))
            if (task.extension().empty())  // it has ended
                if (Status added = addImages(task, images); !added) return added.error();
    }
    if (images.files.empty())
        return badInput(fmt::format("no image of a frame (NAME_0000.png) is in {}; draw them with run --images", fmt::join(folders, ", ")));
    int next = images.files.begin()->first;
    for (const auto& [frame, path] : images.files) {
        if (frame != next)
            return badInput(fmt::format("the image of frame {} is missing; draw it, or name the folder that it is in", next));
        ++next;
    }
    return std::move(images.files);
}

Status joinImages(const std::map<int, std::string>& images, const std::string& file, const Graceful& graceful) {
    Progress progress("join");
    std::optional<VideoWriter> video;
    int width = 0, height = 0, done = 0;
    for (const auto& [frame, path] : images) {
        if (graceful.interrupted()) return ok();  // the video is dropped
        const Result<Image> image = loadImage(path);
        if (!image) return image.error();
        if (!video) {
            width = image->width;
            height = image->height;
            Result<VideoWriter> made = VideoWriter::open(file, width, height, kFramesPerSecond);
            if (!made) return made.error();
            video = std::move(*made);
        }
        if (image->width != width || image->height != height)
            return badInput(fmt::format("{} has {}x{} pixels, but the images before it {}x{}; draw all with the same --size", path,
                                        image->width, image->height, width, height));
        const size_t row = 4 * static_cast<size_t>(width);
        std::vector<uint8_t> upright(image->rgba.size());  // the top row first
        for (size_t y = 0; y < static_cast<size_t>(height); ++y)
            std::memcpy(&upright[y * row], &image->rgba[(static_cast<size_t>(height) - 1 - y) * row], row);
        if (Status added = video->add(upright); !added) return added;
        progress.show(static_cast<double>(++done) / static_cast<double>(images.size()), fmt::format("frame {}", frame));
    }
    return video->close();
}

}  // namespace

int joinVerb(const Arguments& arguments) {
    ArgumentReader reader("join",
                          "Makes one video of images that run --images wrote: of one folder, of pieces, or of the tasks of a sweep.");
    std::vector<std::string> folders;
    std::string file = "out.mp4";
    reader.positional("DIR", "folders of the images, or a sweep's folder; images are ordered by the frame in their names", folders);
    reader.option("--video", "FILE.mp4", "video file; default: out.mp4", file);
    reader.footer("The video is bit for bit the one that a single run of all frames writes.");
    if (std::optional<int> code = reader.read(arguments)) return *code;
    if (folders.empty()) return report(badInput("name a folder of images, for example: rivulet join out (see 'rivulet join --help')"));
    const Result<std::map<int, std::string>> images = imagesOf(folders);
    if (!images) return report(images.error());
    const Graceful graceful;
    if (Status joined = joinImages(*images, file, graceful); !joined) return report(joined.error());
    if (graceful.interrupted()) return graceful.status();
    fmt::print("{}, frames {} to {}\n", printable(file), images->begin()->first, images->rbegin()->first);
    return kDone;
}

}  // namespace rivulet
