// Descriptor: an open file, closed by its owner; the system's error numbers in words.
#pragma once

#include <string>
#include <utility>

#include "engine/core/abi.h"

namespace rivulet {

class Descriptor {
  public:
    Descriptor() = default;
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() { (void)close(); }
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    bool valid() const { return fd_ >= 0; }
    int get() const { return fd_; }
    int release() { return std::exchange(fd_, -1); }
    int close();  // 0, or errno: what was written may be lost

  private:
    int fd_ = -1;
};

// As open(2), not inherited by programs that this process starts, of bytes and not of text; path is UTF-8. Not valid: errno says why. Never
// 0, 1 or 2, even if the process has closed them: text that is printed must not reach a data file.
extern const int kNeverWaits;  // a flag: opening a pipe or device does not wait
Descriptor openDescriptor(const std::string& path, int flags, unsigned mode = 0666);

// "it does not exist", "the disk is full", ...
std::string reasonOf(int error);

}  // namespace rivulet
