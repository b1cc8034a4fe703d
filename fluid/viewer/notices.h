// Notices: the last 4 messages of the log, from any thread.
#pragma once

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/message_line.h"

namespace rivulet {

class Notices {
  public:
    void add(std::string_view text) {
        constexpr size_t kMost = 4;
        const std::lock_guard<std::mutex> lock(mutex_);
        if (sentences_.size() == kMost) sentences_.erase(sentences_.begin());
        sentences_.push_back(messageLine(text));
    }
    std::vector<std::string> all() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return sentences_;
    }
    void forget(const std::string& which) {
        const std::lock_guard<std::mutex> lock(mutex_);
        std::erase(sentences_, which);
    }
    void clear() {
        const std::lock_guard<std::mutex> lock(mutex_);
        sentences_.clear();
    }

  private:
    mutable std::mutex mutex_;
    std::vector<std::string> sentences_;  // the newest last
};

}  // namespace rivulet
