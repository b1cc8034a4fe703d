// Private files of a user on Windows: the folders of a user's profile are closed to other users by their access lists, which new files take
// over. Caches are in the profile (cacheFolder), so that nothing more has to be checked than what kind of file it is.
#include "engine/core/private_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "engine/core/file.h"
#include "engine/core/file_system.h"

namespace rivulet {

Status checkPrivateFolder(const std::string&) { return ok(); }

Status makePrivateFolder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error) return ok();
    return failed(fmt::format("the folder {} cannot be made: {}", folder, error.message()));
}

Status checkPrivateFile(const std::string& path) {
    const FileFacts facts = factsOf(path);
    if (facts.kind == FileFacts::Kind::none || facts.kind == FileFacts::Kind::regular) return ok();
    return failed(fmt::format("{} is not a plain file", path));
}

Status writePrivateFile(const std::string& path, std::string_view bytes) { return writeFileAtomic(path, bytes, 0600, Sync::none); }

}  // namespace rivulet
