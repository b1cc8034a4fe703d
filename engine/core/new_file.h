// NewFile: a file that takes its name when it is complete. Until then it has a temporary name beside it, and an older file of the name
// stays as it is: after a full disk, an error, an exception, a signal or a crash it is whole.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rivulet {

// Whether a file must be on the disk before it takes its name, so that it is whole after a power failure too: true of all but caches, whose
// entries have checksums.
enum class Sync { disk, none };

// 1 for /dev/stdout, 2 for /dev/stderr, N for /dev/fd/N and /proc/self/fd/N: what is written there goes into the open descriptor, where it
// stands. Nothing: another name.
std::optional<int> descriptorOf(const std::string& path);

class NewFile {
  public:
    // Follows a link. A device or pipe is opened and written into. `mode`: permissions, less the umask, if no older file gives its own.
    // Error (failed): no such file can be made, and why; nothing has changed.
    static Result<NewFile> open(const std::string& path, unsigned mode = 0666);
    // Without commit(): the temporary file is removed.
    ~NewFile();
    NewFile(NewFile&&) noexcept;
    NewFile& operator=(NewFile&&) noexcept;

    // Appends. `part`: what the bytes are, for the message. Error (failed): disk full; commit() then fails too.
    Status write(std::string_view bytes, std::string_view part = {});
    // Gives the file its name. Error (failed): an older file of this name is unchanged.
    Status commit(Sync sync = Sync::disk);
    // Gives the file its name now, if no file has it. What is written then stays, complete or not: for a file that is read up to where it
    // ends.
    void publish();

    // The name that the file has at the moment, for another program that writes it.
    const std::string& name() const;

  private:
    struct Impl;
    explicit NewFile(std::unique_ptr<Impl> impl);
    Error cannotWrite(int error, std::string_view part = {}) const;
    std::unique_ptr<Impl> impl_;
};

// Removes the temporary files of all NewFiles of this process: for a handler of signals that end the process. Safe in one.
void removeTemporaryFiles() noexcept;

}  // namespace rivulet
