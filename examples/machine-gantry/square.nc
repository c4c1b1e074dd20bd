(square of 50 mm with fillets of 5 mm, as fast as the limits let it)
G21 G17 G90 G64
G1 X45 Y0 F30000
G3 X50 Y5 J5
G1 Y45
G3 X45 Y50 I-5
G1 X5
G3 X0 Y45 J-5
G1 Y5
G3 X5 Y0 I5
G1 X25
M30
