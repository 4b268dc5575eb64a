#pragma once
// "Rebuild: lightmap, transport: about 12 s; 120 M rays, 27 MB [Rebuild] [Revert]": seen while an edit waits for a rebuild that takes a second and more, or that would be refused.
#include <QFrame>
#include <QTimer>

class QLabel;
class QPushButton;

namespace hl::ui {

class Document;

class RebuildBar : public QFrame {
  Q_OBJECT
 public:
  explicit RebuildBar(Document&, QWidget* parent = nullptr);

  QString text() const;
  QPushButton* rebuildButton() const { return rebuild_; }
  QPushButton* revertButton() const { return revert_; }

 private:
  void refresh();

  Document& document_;
  QLabel* label_;
  QPushButton *rebuild_, *revert_;
  QTimer patience_;  ///< until what is not known yet is worth a line
};

}  // namespace hl::ui
