#pragma once
// The linear images that parts of the window need of each frame: what they ask for together is what the engine publishes, and nothing more.
#include <QObject>
#include <map>
#include <set>
#include <string>

#include "ui/engine_link.h"

namespace hl::ui {

class ImageFeed : public QObject {
  Q_OBJECT
 public:
  explicit ImageFeed(EngineLink&, QObject* parent = nullptr);
  /// What `who` needs from now on, in place of what it needed; {} nothing.
  void want(const QObject* who, const std::set<std::string>& names);
  /// Tells a session that was started anew.
  void sendAll();

 private:
  EngineLink& link_;
  std::map<const QObject*, std::set<std::string>> wanted_;
  std::vector<std::string> sent_;
};

}  // namespace hl::ui
