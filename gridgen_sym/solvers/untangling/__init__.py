"""From a folded grid to a valid one: a list of strategies, tried in turn.

`strategies` holds the list, `search` what all strategies share. A new strategy is one file with one frozen object that
meets `search.Strategy`, and one entry in the list.
"""
