"""From derived equations to sources: programs as data, lowered, printed and put into templates."""
