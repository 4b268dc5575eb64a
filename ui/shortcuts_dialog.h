#pragma once
// Every key and gesture. Keys of menus are read off the menus, so the list cannot fall behind them.
#include <QDialog>

class QMenuBar;

namespace hl::ui {

class ShortcutsDialog : public QDialog {
  Q_OBJECT
 public:
  ShortcutsDialog(const QMenuBar&, QWidget* parent);
};

}  // namespace hl::ui
