#pragma once
// Regions of interest by number: name, corner and size in pixels of the picture. The same list that is drawn in the viewport.
#include <QWidget>

#include "ui/document.h"

class QPushButton;
class QTableWidget;

namespace hl::ui {

class RegionsEditor : public QWidget {
  Q_OBJECT
 public:
  explicit RegionsEditor(Document&, QWidget* parent = nullptr);
  /// Adds one, in shares of the picture, under the next free name.
  void add(const QRectF& shares);

 protected:
  void showEvent(QShowEvent*) override;
  void hideEvent(QHideEvent*) override;

 signals:
  void shown(bool visible);
  void drawWanted();

 private:
  void read();
  void cellEdited(int row, int column);

  Document& document_;
  QTableWidget* table_;
  QPushButton *remove_, *reset_;
  bool filling_ = false;
};

}  // namespace hl::ui
