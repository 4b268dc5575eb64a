#pragma once
// Profiler: where a frame's time goes, and the memory. Drawn at most ten times a second, and only while it is seen.
#include <QTimer>
#include <QWidget>
#include <memory>

#include "engine/session/session.h"

class QTableWidget;

namespace hl::ui {

class PassBars;
class PassModel;
class PassPalette;

class ProfilerPanel : public QWidget {
  Q_OBJECT
 public:
  ProfilerPanel(PassPalette&, PassModel&, QWidget* parent = nullptr);
  void showFrame(std::shared_ptr<const FrameResult>);
  PassBars& bars() { return *bars_; }

 protected:
  void showEvent(QShowEvent*) override;

 private:
  void draw();
  void showMemory(const FrameResult&);

  PassBars* bars_;
  QTableWidget* memory_;
  QTimer timer_;
  std::shared_ptr<const FrameResult> frame_;
  bool stale_ = false;
  std::string technique_;
};

/// "1.5 MiB"
QString bytesText(uint64_t bytes);

}  // namespace hl::ui
