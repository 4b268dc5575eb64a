#pragma once
// Probes: how many, what they see of the scene, and the list of those set by hand, which are edited here or in the viewport.
#include <QWidget>

#include "ui/document.h"

class QLabel;
class QPushButton;
class QTableWidget;

namespace hl::ui {

class ProbesPanel : public QWidget {
  Q_OBJECT
 public:
  explicit ProbesPanel(Document&, QWidget* parent = nullptr);
  void showFrame(std::shared_ptr<const FrameResult>);
  /// Those in the list: by hand, or as placed.
  std::vector<vec3> probes() const;
  /// Probes by hand from here on: those that are placed become the preset's own, and probes.placement manual. One step of undo; none where they are that already.
  void takeOver();
  void add(const vec3&);
  void move(size_t probe, const vec3& to);
  void remove(size_t probe);
  void select(std::optional<size_t>);

 signals:
  void editWanted(bool on);
  void selected(std::optional<size_t> probe);

 public slots:
  void setEditing(bool);

 private:
  void read();
  void cellEdited(int row, int column);
  bool byHand() const;
  void edit(std::vector<vec3>, const QString& what);

  Document& document_;
  std::shared_ptr<const FrameResult> frame_;
  QLabel* facts_;
  QTableWidget* table_;
  QPushButton *edit_, *add_, *remove_, *reset_;
  bool filling_ = false;
};

}  // namespace hl::ui
