#include "ui/image_feed.h"

namespace hl::ui {

ImageFeed::ImageFeed(EngineLink& link, QObject* parent) : QObject(parent), link_(link) {}

void ImageFeed::want(const QObject* who, const std::set<std::string>& names) {
  if (names.empty())
    wanted_.erase(who);
  else
    wanted_[who] = names;
  std::set<std::string> all;
  for (const auto& [unused, some] : wanted_) all.insert(some.begin(), some.end());
  const std::vector<std::string> next(all.begin(), all.end());
  if (next == sent_) return;
  sent_ = next;
  link_.setImagesWanted(sent_);
}

void ImageFeed::sendAll() {
  if (!sent_.empty()) link_.setImagesWanted(sent_);
}

}  // namespace hl::ui
