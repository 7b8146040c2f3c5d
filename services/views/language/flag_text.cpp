#include "services/views/language/flag_text.hpp"

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline views {

namespace {

constexpr std::string_view german_meanings[] = {
    "Innerhalb des Schritts fehlen Abtastwerte dieser Quelle; ausgewertet sind die übrigen.",
    "Abtastwerte, deren Zeitstempeln das Gerät oder ihre Prüfung nicht traut, sind "
    "ausgelassen.",
    "Abtastwerte, die das Gerät nicht gemessen hat, sind ausgelassen.",
    "Vom eingeschwungenen Sinus wurde weniger aufgezeichnet als geplant; die "
    "Messunsicherheit durch Rauschen ist entsprechend größer.",
    "Die Messunsicherheit der Phase enthält keinen Beitrag der Zeitstempel dieser Quelle.",
    "Der Schritt endete vorzeitig; ausgewertet ist, was bis dahin aufgezeichnet war.",
    "Der Wert gilt für seine Frequenz und seinen Pegel; welche der geplanten Wiederholungen "
    "er ist, ist nicht bekannt.",
    "Das Bezugsnormal zeigt einen anderen Pegel als geplant; der Wert gilt für den gezeigten "
    "Pegel.",
    "Abtastwerte liegen an einem Ende des Messbereichs, wo der Sinus abgeschnitten wird.",
    "Der Kanal wiederholt einen Wert, während sich das Signal ändert.",
    "Der Kanal zeigt mehr Oberschwingungen, als ISO 16063-21 für die Anregung zulässt.",
    "Wann der Sinus eingeschwungen war, zeigen die Daten nicht; die geplante Einschwingzeit "
    "ist ausgelassen.",
    "Der Sinus war zu Beginn der Auswertung noch nicht eingeschwungen.",
    "Es kamen weniger Serien als geplant oder waren weniger brauchbar; die Messunsicherheit "
    "ist entsprechend größer.",
    "Serien anderer Länge, Abtastrate oder Kanalzahl sind ausgelassen: Einstellungen eines "
    "Geräts haben sich im Schritt geändert.",
    "Aufzeichnungen dieser Quelle waren nicht brauchbar oder zu viele.",
    "Wie die Serie nach dem Trigger beginnt, zeigen die Phasen nicht; die Messunsicherheit "
    "enthält beide Möglichkeiten.",
    "Rauschen und Schwelle des Triggers sind in der Phase nicht korrigiert.",
    "Die vorgesehene Prüfung durch die Monte-Carlo-Methode war nicht möglich; Wert und "
    "Messunsicherheit gelten ohne sie.",
    "Die Phase strebt gegen 180° bei 0 Hz, oder Wiederholungen zeigen in entgegengesetzte "
    "Richtungen: Kalibriergegenstand oder Bezugsnormal sind umgekehrt orientiert oder "
    "angeschlossen.",
    "Die Gruppenlaufzeit ist um mehr als das Dreifache ihrer Messunsicherheit negativ.",
    "Die Messunsicherheit der Phase enthält keinen Beitrag der Laufzeit des Sync-ADU.",
    "Die Messunsicherheit enthält keinen Beitrag des Bezugsnormals.",
    "Die Messunsicherheit enthält keinen Beitrag des Netzbrummens: Es war in dieser Messung "
    "nicht von der Anregung zu trennen.",
    "Die Messunsicherheit enthält keinen Beitrag von Oberschwingungen, die bei dieser "
    "Abtastrate auf die Frequenz der Anregung fallen.",
    "Anschläge, stehende Werte und Klirren waren in diesem Kanal nicht zu prüfen; Wert und "
    "Messunsicherheit gelten ohne diese Prüfung.",
    "Die Scheitel des Sinus sind flacher oder spitzer als die des Bezugsnormals, wie an "
    "einem Anschlag vor einem Filter.",
    "Übertragungskoeffizient oder Laufzeit des Kanals haben sich während des Schritts "
    "geändert, oder Abtastwerte fehlen oder sind doppelt.",
    "Eine kurze Störung ist aus der Aufzeichnung ausgelassen.",
    "Die Zeitstempel dieser Quelle springen innerhalb des Schritts.",
    "Die Zeitstempel streuen so, dass der Sinus sichtbar verkürzt ist; das ist korrigiert "
    "und in der Messunsicherheit berücksichtigt.",
    "Die Zeitstempel sagen nicht, wann die Werte gemessen wurden: Werte sind gehalten, "
    "vertauscht oder gruppenweise gelesen.",
    "Das Rauschen ist langsam gegenüber der Aufzeichnung, die seine Größe daher nicht "
    "zeigen kann.",
    "Serien unterscheiden sich um mehr als ihr Rauschen, oder eine Serie ändert sich in "
    "sich.",
    "Phase und ihre Messunsicherheit gelten ohne die Laufzeit des Triggers des Oszilloskops.",
    "Die Messunsicherheit der Phase enthält keinen Beitrag der Laufzeit zwischen den Kanälen "
    "des Referenzsystems.",
    "Die Gruppenlaufzeit ist mehrdeutig: Die Frequenzen liegen zu weit auseinander.",
    "Die Phasen liegen über der Frequenz nicht auf einer Geraden; keine einzelne Laufzeit "
    "beschreibt den Kalibriergegenstand.",
    "Zwei unabhängig voneinander gemessene Größen widersprechen sich um mehr, als Zufall und "
    "Toleranzen der Geräte zulassen.",
    "Ein anderes Programm hat unter dem Namen dieser Quelle gesendet; ausgewertet ist, was "
    "von dem ersten kam.",
    "Diese Version der Software kennt die Kennzeichnung nicht.",
};

} // namespace

std::string_view german_meaning_of(ResultFlag flag) {
  return per_enumerator(flag, german_meanings);
}

} // namespace dyncal::inline views
